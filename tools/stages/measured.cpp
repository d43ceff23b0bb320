#include "tools/stages/measured.h"

#include "formats/error.h"
#include "lib/core/formatted.h"
#include "lib/core/json.h"
#include "lib/core/json_file.h"

namespace tempolux::tools {
namespace {

using Json = nlohmann::ordered_json;

/// "AQM 8 % with 6250 photons a frame (9.6 % with 3125); asked: 10 %"
std::string in_words(const Json& chosen, const Json& tried, double share) {
  const auto words = [](const Json& one) {
    return formatted("%.3g %% with ", 100 * one.at("aqm").get<double>()) +
           std::to_string(one.at("photons").get<std::uint64_t>());
  };
  std::string others;
  for (const Json& one : tried)
    if (one != chosen) others += (others.empty() ? " (" : ", ") + words(one);
  return "measured: AQM " + words(chosen) + " photons a frame" + others + (others.empty() ? "" : ")") +
         formatted("; asked: %.3g %%", 100 * share);
}

Measured chosen_of(const Json& segment, double share) {
  const Json& tried = segment.at("tried");
  const Json* chosen = nullptr;
  for (const Json& one : tried) {  // from few photons to many
    if (one.at("photons").get<std::uint64_t>() == 0) throw InputError("photons are 0");
    const double aqm = one.at("aqm").get<double>();
    if (!chosen || (chosen->at("aqm").get<double>() > share && aqm < chosen->at("aqm").get<double>())) chosen = &one;
  }
  if (!chosen) throw InputError("nothing was tried");
  return {chosen->at("photons").get<std::uint64_t>(), in_words(*chosen, tried, share)};
}

}  // namespace

std::map<int, Measured> measured_photons(const std::string& path, double share) {
  const Json table = read_json(path);
  std::map<int, Measured> measured;
  try {
    if (table.at("format") != "tempolux measured") throw InputError("another format");
    for (const Json& segment : table.at("segments"))
      measured[segment.at("first").get<int>()] = chosen_of(segment, share);
  } catch (const std::exception& error) {
    throw InputError(path + ": " + error.what() + "; make measure METHOD=preview writes it anew");
  }
  return measured;
}

}  // namespace tempolux::tools
