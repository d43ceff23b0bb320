// tools/common/history.cpp -- a run's line of history, and its rule for make.
#include <algorithm>
#include <filesystem>
#include <string>

#include "tools/common/tool_state.h"

namespace tempolux::tools {
namespace {

/// Quotes a word for a shell; control characters, which could fake lines, become '?'.
std::string quoted(const std::string& word) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_.,:=+@%/#-").find(c) != std::string_view::npos || static_cast<unsigned char>(c) >= 0x80;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string text = "'";
  for (const char c : word) {
    if (c == '\'') text += "'\\''";
    else text += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  }
  return text + "'";
}

std::string without_folder(const std::string& name) {
  const std::filesystem::path path(name);
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

/// The first long name of an option, else its short name: "--frames" for "--frames,--frame".
std::string option_name(const CLI::Option& option) {
  if (!option.get_lnames().empty()) return "--" + option.get_lnames().front();
  return "-" + option.get_snames().front();
}

bool is_positional(const CLI::Option& option) { return option.get_lnames().empty() && option.get_snames().empty(); }

/// Escapes a file name for a rule of make.
std::string make_word(const std::string& name) {
  std::string text;
  for (const char c : name) {
    if (c == ' ' || c == '#' || c == '\\' || c == ':') text += '\\';
    if (c == '$') text += '$';
    text += c;
  }
  return text;
}

}  // namespace

std::string Tool::history_line(std::optional<int> frame) const {
  std::string line = "tempolux " TEMPOLUX_VERSION " " + state_->name;
  const auto add = [&](const CLI::Option& option) {
    for (const std::string& value : option.results()) {
      const bool named = frame && state_->files.contains(&option) &&
                         (has_frame_pattern(value) || value.find("%%") != std::string::npos);
      line += " " + quoted(without_folder(named ? frame_name(value, *frame) : value));
    }
  };
  const std::vector<const CLI::Option*> options =
      std::as_const(state_->app).get_options([&](const CLI::Option* option) {
        return !state_->left_out_of_history.contains(option);
      });
  for (const CLI::Option* option : options)
    if (is_positional(*option)) add(*option);
  for (const CLI::Option* option : options) {
    if (is_positional(*option)) continue;
    if (frame && option_name(*option) == "--frames") {
      line += " --frame " + std::to_string(*frame);
    } else if (option->count() > 0) {
      line += " " + option_name(*option);
      if (option->get_expected_max() > 0) add(*option);
    }
  }
  return line + "\n";
}

std::vector<std::string> Tool::scene_words() const { return state_->given(state_->of_scene); }
std::vector<std::string> Tool::lens_words() const { return state_->given(state_->of_lens); }

std::vector<std::string> Tool::State::given(const std::set<const CLI::Option*>& of) const {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options()) {
    if (!of.contains(option) || option->count() == 0) continue;
    const std::string word = option_name(*option);
    if (option->get_expected_max() == 0) words.push_back(word);
    else
      for (const std::string& value : option->results()) {
        const bool file = word == "--volume" ? value != "none" : word == "--environment" && !is_color(value);
        words.push_back(word + "=" + (file ? std::filesystem::absolute(value).string() : value));
      }
  }
  return words;
}

std::string Tool::State::depfile_text(const std::vector<std::string>& targets) const {
  std::string rule, phony;
  for (const std::string& target : targets) rule += (rule.empty() ? "" : " ") + make_word(target);
  rule += ":";
  for (const std::string& file : dependencies) {
    rule += " \\\n  " + make_word(file);
    if (std::ranges::find(targets, file) == targets.end()) phony += "\n" + make_word(file) + ":\n";
  }
  return rule + "\n" + phony;
}

}  // namespace tempolux::tools
