// tools/common/manual.h -- a tool's options as a table of its page in docs/tools, and as bash completion.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tempolux::tools {

/// The options that --help shows, as a table in Markdown. docs/make_tools.sh puts the table into the tool's page, from
/// which cmake/man_page.awk makes the man page.
std::string option_table(const CLI::App& app);

/// A script for share/bash-completion/completions: completes options, and the values of options with a list of words;
/// anything else is completed as a file name.
std::string bash_completion(const CLI::App& app);

}  // namespace tempolux::tools
