// tools/common/manual.cpp -- writes man pages, Markdown pages and bash completion.
#include "tools/common/manual.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <sstream>
#include <vector>

#include "tools/common/option_words.h"

namespace tempolux::tools {
namespace {

/// Escapes text for roff: backslashes, hyphens and control lines.
std::string roff(const std::string& text) {
  std::string out = !text.empty() && (text[0] == '.' || text[0] == '\'') ? "\\&" : "";
  for (const char c : text) {
    if (c == '\\') out += "\\e";
    else if (c == '-') out += "\\-";
    else out += c;
  }
  return out;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

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

std::string what_it_does(const CLI::Option& option) {
  std::string text = roff(option.get_description());
  if (const std::string limits = limits_of(option); !limits.empty()) text += " (" + limits + ")";
  if (!option.get_default_str().empty()) text += " [" + roff(option.get_default_str()) + "]";
  if (option.get_required()) text += " (required)";
  if (!option.get_envname().empty()) text += " (environment: " + roff(option.get_envname()) + ")";
  return text;
}

std::string entry(const CLI::Option& option) {
  std::string head;
  for (const std::string& name : names_of(option)) head += (head.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
  if (head.empty()) head = "\\fI" + roff(option.get_single_name()) + "\\fR";
  else if (takes_value(option)) head += " \\fI" + roff(value_name(option)) + "\\fR";
  return ".TP\n" + head + "\n" + what_it_does(option) + "\n";
}

/// "Trace photons." as it follows a name: "trace photons".
std::string as_part_of_a_line(std::string text) {
  if (!text.empty() && text.back() == '.') text.pop_back();
  if (!text.empty()) text[0] = char(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

std::string paragraphs(const char* text) {
  std::string out;
  for (const std::string& line : lines_of(text)) out += line.empty() ? ".PP\n" : roff(line) + "\n";
  return out;
}

std::string files(const char* text) {
  std::string out;
  for (const std::string& line : lines_of(text)) {
    const std::size_t colon = line.find(": ");
    out += ".TP\n\\fI" + roff(line.substr(0, colon)) + "\\fR\n" +
           (colon == std::string::npos ? "\n" : roff(line.substr(colon + 2)) + "\n");
  }
  return out;
}

std::string examples(const char* text) {
  std::string out;
  for (const std::string& line : lines_of(text))
    out += line.starts_with("# ") ? ".PP\n" + roff(line.substr(2)) + "\n" : ".PP\n.EX\n    " + roff(line) + "\n.EE\n";
  return out;
}

std::string see_also(const char* tools) {
  std::string out;
  std::istringstream words(tools);
  for (std::string word; words >> word;) out += (out.empty() ? "\\fB" : ",\n\\fB") + roff(word) + "\\fR(1)";
  return out + "\n";
}

/// Escapes text for Markdown; names of pages of this tree become links from docs/tools.
std::string markdown(const std::string& text) {
  std::string out, word;
  const auto end_word = [&] {
    const std::size_t last = word.find_last_not_of(".,;:)");
    const std::string page = word.substr(0, last + 1);
    const std::size_t first = page.find_first_not_of('(');
    const std::string name = first == std::string::npos ? page : page.substr(first);
    const bool ours = name.starts_with("docs/") || name.starts_with("formats/") || name.starts_with("pipelines/");
    if (ours && name.ends_with(".md"))
      out += page.substr(0, first) + "[" + name + "](../../" + name + ")" + word.substr(last + 1);
    else out += word;
    word.clear();
  };
  for (const char c : text) {
    if (c == ' ' || c == '\n') {
      end_word();
      out += c;
    } else if (c == '|' || c == '*' || c == '_' || c == '<' || c == '#') {
      word += std::string(c == '_' ? "" : "\\") + c;
    } else {
      word += c;
    }
  }
  end_word();
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

std::string man_page(const CLI::App& app) {
  const std::string name = app.get_name();
  const ManualText text = manual_text(name);
  std::string page = ".TH " + name + " 1 \"\" \"tempolux " TEMPOLUX_VERSION "\" \"tempolux\"\n.SH NAME\n" + roff(name) +
                     " \\- " + roff(as_part_of_a_line(app.get_description())) + "\n.SH SYNOPSIS\n\\fB" + roff(name) +
                     "\\fR [\\fIOPTIONS\\fR]\\fI" + roff(positional_words(app)) + "\\fR";
  page += "\n.SH DESCRIPTION\n" + paragraphs(text.description) + ".SH OPTIONS\n";
  for (const bool positional : {true, false})
    for (const CLI::Option* option : options_of(app, positional)) page += entry(*option);
  page +=
      ".PP\nDefaults stand in brackets. Counts take k, M and G (powers of 1000), sizes KiB, MiB and GiB.\n"
      ".SH EXIT STATUS\n.TP\n0\ndone, all outputs complete\n.TP\n1\ndiffers or not valid: only "
      "\\fBaqm\\-compare\\fR with \\fB\\-\\-fail\\-above\\fR and \\fBtempolux\\-info\\fR with \\fB\\-\\-check\\fR or "
      "\\fB\\-\\-diff\\fR\n.TP\n2\nusage; bad or stale input\n.TP\n3\ncould not be done: no memory, disk full, write "
      "failed\n.TP\n128+n\nended by signal n; no output is left unfinished\n"
      ".SH ENVIRONMENT\n.TP\nTEMPOLUX_THREADS\nthreads where \\fB\\-\\-threads\\fR is not given\n";
  if (*text.files) page += ".SH FILES\n" + files(text.files);
  if (*text.examples) page += ".SH EXAMPLES\n" + examples(text.examples);
  if (*text.see_also) page += ".SH SEE ALSO\n" + see_also(text.see_also);
  return page;
}

std::string markdown_page(const CLI::App& app) {
  const std::string name = app.get_name();
  const ManualText text = manual_text(name);
  std::string page = "# " + name + "\n\n" + markdown(app.get_description()) + "\n\n    " + name + " [OPTIONS]" +
                     positional_words(app) + "\n\n" + markdown(text.description) + "\n\n";
  if (*text.examples) {
    page += "## Examples\n";
    for (const std::string& line : lines_of(text.examples))
      page += line.starts_with("# ") ? "\n" + markdown(line.substr(2)) + "\n" : "\n    " + line + "\n";
  }
  page +=
      "\n## Options\n\nCounts take k, M and G (powers of 1000), sizes KiB, MiB and GiB.\n\n| option | what it does | "
      "default |\n|---|---|---|\n";
  for (const bool positional : {true, false})
    for (const CLI::Option* option : options_of(app, positional)) page += markdown_entry(*option);
  if (*text.files) {
    page += "\n## Files\n\n";
    for (const std::string& line : lines_of(text.files)) page += "- " + markdown(line) + "\n";
  }
  if (*text.see_also) {
    page += "\nSee also:";
    std::istringstream words(text.see_also);
    for (std::string word; words >> word;) page += " [" + word + "](" + word + ".md)";
    page += ". Exit codes: [tools/README.md](../../tools/README.md). This page is printed by `" + name +
            " --help-markdown`.\n";
  }
  return page;
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
