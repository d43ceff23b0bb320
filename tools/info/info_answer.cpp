#include "tools/info/info_answer.h"

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "formats/error.h"
#include "lib/core/json.h"
#include "lib/scene/gltf_load.h"
#include "tools/info/each_file.h"

namespace tempolux::tools {
namespace {

void print(const Facts& facts, bool as_json) {
  if (as_json) std::cout << facts.dump(2, ' ', false, Facts::error_handler_t::replace) << '\n';
  else std::cout << facts_as_text(facts);
}

/// Checks files. Returns exit code 1 if a file is not valid; a missing file is bad usage.
int check_files(Tool& tool, const Request& request) {
  int code = exit_ok;
  for (const std::string& file : request.files) {
    try {
      request.whole ? check_end(file) : void(facts_of(file, false));
      if (!request.json) std::cout << file << (request.whole ? ": whole\n" : ": valid\n");
    } catch (const InputError& error) {
      if (file != "-" && (!std::filesystem::exists(file) || std::filesystem::is_directory(file))) throw;
      tool.warn(error.what());
      code = exit_differs;
    }
  }
  return code;
}

/// Adds the names of objects beside their ids.
void name_objects(const std::vector<std::string>& names, Facts& facts) {
  if (!facts.contains("by_object")) return;
  for (Facts& line : facts["by_object"])
    if (const std::size_t id = line["object"]; id < names.size()) line["name"] = names[id];
}

int print_files(Tool& tool, const Request& request) {
  Facts all = Facts::array();
  std::vector<std::string> names;
  if (!request.scene.empty()) {
    tool.depends_on(request.scene);
    names = load_gltf(request.scene).object_names;
  }
  const auto read = [](const std::string& file) { return facts_of(file, true); };
  each_file(request.files, read, [&](const std::string& file, Facts facts) {
    name_objects(names, facts);
    if (request.digest && !request.json) std::cout << facts["digest"].get<std::string>() << "  " << file << '\n';
    else if (request.digest) all.push_back({{"file", file}, {"digest", facts["digest"]}});
    else if (request.json) all.push_back(facts);
    else print(facts, false);
  });
  if (request.json) print(all.size() == 1 ? all[0] : all, true);
  return exit_ok;
}

/// The single file that the option accepts.
const std::string& only_file(const Request& request, const char* option) {
  if (request.files.size() != 1) throw InputError(std::string(option) + ": takes one file");
  return request.files.front();
}

}  // namespace

int answer(Tool& tool, Request& request) {
  if (request.whole && std::ranges::find(request.files, "-") != request.files.end())
    throw InputError("--whole: looks at the ends of files; --check reads standard input");
  for (const std::string& file : request.files) tool.depends_on(file);
  if (request.diff) {
    if (request.files.size() != 2) throw InputError("--diff: takes two files");
    const Facts facts = difference_of(request.files[0], request.files[1]);
    const bool equal = facts["equal"];
    if (request.json || !equal || !facts["differing"].empty()) print(facts, request.json);
    return equal ? exit_ok : exit_differs;
  }
  if (request.check || request.whole) return check_files(tool, request);
  if (request.account) {
    const FramesAccount account = account_of_frames(request.files);
    if (!account.line.empty()) std::cout << account.line << '\n';
    for (const std::string& warning : account.warnings) tool.warn(warning);
    return exit_ok;
  }
  if (request.written().empty()) return print_files(tool, request);
  const bool ply = request.exported.ends_with(".ply");
  if (!request.exported.empty() && !ply && request.exported != "-" && !request.exported.ends_with(".csv"))
    throw InputError("--export " + request.exported + ": the name must end in .ply or .csv");
  using Kind = Output::Kind;
  Output output(request.written(), request.exported.empty() || ply ? Kind::binary : Kind::text);
  request.picture.progress = tool.progress_sink();
  if (!request.sheet.empty()) write_sheet(request.files, request.picture, output);
  else if (!request.png.empty()) write_picture(only_file(request, "--png"), request.picture, output);
  else export_points(only_file(request, "--export"), ply ? "ply" : "csv", output);
  output.commit();
  return exit_ok;
}

}  // namespace tempolux::tools
