// tools/common/tool_state.h -- the members of Tool; for tool_main.cpp, options.cpp and history.cpp only.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/common/cli.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

struct Tool::State {
  std::string name;
  int argc;
  char** argv;
  CLI::App app;
  Common common;
  Stats stats;
  std::set<const CLI::Option*> left_out_of_history;
  std::set<const CLI::Option*> of_scene;  ///< options with which every tool must read the scene
  std::set<const CLI::Option*> of_lens;   ///< options with which every tool must see through the lens
  std::set<const CLI::Option*> files;  ///< of file_option(): values may be patterns, unlike names of scenes and cameras

  std::vector<std::string> dependencies;

  // Messages may come from any thread.
  std::mutex message_mutex;
  std::set<std::string> warnings;
  bool bar_allowed = false, bar_shown = false;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now(), bar_time = start;

  State(std::string tool, std::string what, int count, char** values)
      : name(std::move(tool)), argc(count), argv(values), app(std::move(what), name) {}

  /// True if the file TEMPOLUX_SAID has this warning: an earlier tool of the run has given it.
  bool was_said(const std::string& message);
  std::optional<std::set<std::string>> said;

  /// The given ones of these options, as words; names of files are absolute.
  std::vector<std::string> given(const std::set<const CLI::Option*>& of) const;

  bool print_manual() const;
  void apply_limits() const;
  int run(const std::function<int()>& body, const Tool& tool);
  void print_line(const std::string& message);
  void clear_bar();
  std::string depfile_text(const std::vector<std::string>& targets) const;
};

/// Layout of --help: descriptions wrapped, default and "required" at their end.
std::shared_ptr<CLI::FormatterBase> help_formatter();
/// The lines of --version: tool, compiler, and the loaded shared libraries.
std::string version_text(const std::string& tool);

}  // namespace tempolux::tools
