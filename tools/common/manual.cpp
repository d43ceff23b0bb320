// tools/common/manual.cpp -- writes options as Markdown, and bash completion.
#include "tools/common/manual.h"

#include <algorithm>
#include <string>
#include <vector>

#include "tools/common/cli.h"
#include "tools/common/option_words.h"

namespace tempolux::tools {
namespace {

/// The options that --help shows, without (or only) positional arguments.
std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  std::vector<const CLI::Option*> options;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty() && option->get_positional() == positional) options.push_back(option);
  return options;
}

bool takes_value(const CLI::Option& option) { return option.get_expected_max() > 0; }

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

/// Escapes text for a table in Markdown.
std::string markdown(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '<' || c == '#') out += '\\';
    out += c;
  }
  return out;
}

std::string markdown_entry(const CLI::Option& option) {
  std::string head;
  for (const std::string& name : names_of(option)) head += (head.empty() ? "`" : ", `") + name + "`";
  if (head.empty()) head = "`" + option.get_single_name() + "`";
  else if (takes_value(option)) head += " " + value_name(option);
  std::string text = markdown(option.get_description());
  if (const std::string limits = limits_of(option); !limits.empty()) text += " (" + markdown(limits) + ")";
  if (option.get_required()) text += " (required)";
  const std::string preset = option.get_default_str();
  return "| " + head + " | " + text + " | " + (preset.empty() ? "" : "`" + preset + "`") + " |\n";
}

/// The words of an option of type "UNITS:{raw,spec}".
std::string words_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos || close < open) return {};
  std::string words = type.substr(open + 1, close - open - 1);
  std::replace(words.begin(), words.end(), ',', ' ');
  return words;
}

}  // namespace

std::string option_table(const CLI::App& app) {
  std::string table = "| option | what it does | default |\n|---|---|---|\n";
  for (const bool positional : {true, false})
    for (const CLI::Option* option : options_of(app, positional)) table += markdown_entry(*option);
  return table;
}

std::string bash_completion(const CLI::App& app) {
  const std::string name = app.get_name();
  std::string function = "_" + name, all, cases;
  std::replace(function.begin(), function.end(), '-', '_');
  for (const CLI::Option* option : options_of(app, false)) {
    std::string pattern;
    for (const std::string& option_name : names_of(*option)) {
      all += (all.empty() ? "" : " ") + option_name;
      pattern += (pattern.empty() ? "" : "|") + option_name;
    }
    const std::string words = words_of(*option);
    if (!words.empty())
      cases += "    " + pattern + ") COMPREPLY=($(compgen -W '" + words + "' -- \"$word\")); return ;;\n";
    else if (takes_value(*option)) cases += "    " + pattern + ") return ;;\n";
  }
  return "# bash completion for " + name + ", made by " + name + " --help-completion\n" + function +
         "() {\n  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n  COMPREPLY=()\n"
         "  case $before in\n" +
         cases + "  esac\n  [[ $word == -* ]] && COMPREPLY=($(compgen -W '" + all +
         "' -- \"$word\"))\n  return 0\n}\n"
         "complete -o default -F " +
         function + " " + name + "\n";
}

}  // namespace tempolux::tools
