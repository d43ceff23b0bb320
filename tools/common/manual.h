// tools/common/manual.h -- man page and bash completion of a tool, made from the options that --help shows.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tempolux::tools {

/// What a man page says beyond the options. One entry per tool, in manual_texts.cpp.
struct ManualText {
  const char* tool;
  const char* description;  ///< paragraphs, parted by empty lines
  const char* files;        ///< lines "NAME: what it is"
  const char* examples;     ///< lines: a command, or a remark on the next one that begins with "# "
  const char* see_also;     ///< tools, parted by blanks
};

/// Entry of a tool; an empty one if it has none.
ManualText manual_text(const std::string& tool);

/// The page of section 1 as roff (man macros): NAME, SYNOPSIS, DESCRIPTION, OPTIONS, EXIT STATUS, ENVIRONMENT,
/// FILES, EXAMPLES, SEE ALSO.
std::string man_page(const CLI::App& app);

/// The same as a page of docs/tools, in Markdown.
std::string markdown_page(const CLI::App& app);

/// A script for share/bash-completion/completions: options, and the words of those that have a list of words;
/// everything else is completed as a file name.
std::string bash_completion(const CLI::App& app);

}  // namespace tempolux::tools
