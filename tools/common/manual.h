// tools/common/manual.h -- writes a tool's man page and bash completion from the options that --help shows.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tempolux::tools {

/// The text of a man page besides its options. One entry per tool, in manual_texts.cpp.
struct ManualText {
  const char* tool;
  const char* description;  ///< paragraphs, separated by empty lines
  const char* files;        ///< lines "NAME: description"
  const char* examples;     ///< lines: a command, or a comment on the next command that begins with "# "
  const char* see_also;     ///< tools, separated by blanks
};

/// The entry of a tool; empty if it has none.
ManualText manual_text(const std::string& tool);

/// The page of section 1 as roff (man macros): NAME, SYNOPSIS, DESCRIPTION, OPTIONS, EXIT STATUS, ENVIRONMENT,
/// FILES, EXAMPLES, SEE ALSO.
std::string man_page(const CLI::App& app);

/// The same as a page of docs/tools, in Markdown.
std::string markdown_page(const CLI::App& app);

/// A script for share/bash-completion/completions: completes options, and the values of options with a list of words;
/// anything else is completed as a file name.
std::string bash_completion(const CLI::App& app);

}  // namespace tempolux::tools
