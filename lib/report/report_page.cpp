// lib/report/report_page.cpp -- writes the report as Markdown and as HTML.
#include "lib/report/report_page.h"

#include <cstdint>

namespace tempolux {
namespace {

std::string markdown_cell(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '|' || c == '\\' || c == '<' || c == '*' || c == '_' || c == '`') safe += '\\';
    safe += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return safe;
}

std::string html_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&') safe += "&amp;";
    else if (c == '<') safe += "&lt;";
    else if (c == '>') safe += "&gt;";
    else if (c == '"') safe += "&quot;";
    else safe += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return safe;
}

std::string markdown_table(const Table& table) {
  std::string text = "### " + markdown_cell(table.heading) + "\n\n|", rule = "|";
  for (const std::string& cell : table.header) {
    text += " " + markdown_cell(cell) + " |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const auto& row : table.rows) {
    text += "|";
    for (const std::string& cell : row) text += " " + markdown_cell(cell) + " |";
    text += "\n";
  }
  return text + (table.note.empty() ? "" : "\n" + table.note + "\n") + "\n";
}

std::string html_table(const Table& table) {
  std::string text = "<h3>" + html_text(table.heading) + "</h3>\n<table>\n<tr>";
  for (const std::string& cell : table.header) text += "<th>" + html_text(cell) + "</th>";
  text += "</tr>\n";
  for (const auto& row : table.rows) {
    text += "<tr>";
    for (const std::string& cell : row) text += "<td>" + html_text(cell) + "</td>";
    text += "</tr>\n";
  }
  return text + "</table>\n" + (table.note.empty() ? "" : "<p>" + html_text(table.note) + "</p>\n");
}

/// Encodes bytes as in RFC 4648.
std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string figure(const std::string& type, const std::string& bytes, const std::string& caption) {
  return "<figure><img alt=\"" + html_text(caption) + "\" src=\"data:image/" + type + ";base64," + base64(bytes) +
         "\"><figcaption>" + html_text(caption) + "</figcaption></figure>\n";
}

constexpr const char* kStyle =
    "body{font:15px/1.4 sans-serif;margin:2em auto;max-width:72em;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;font-size:13px}td,th{border:1px solid #ccc;padding:2px "
    "8px;text-align:right}"
    "td:first-child,td:nth-child(2),th{text-align:left}img{max-width:100%}"
    "figcaption{font-size:13px;color:#555}";

}  // namespace

std::string report_markdown(const ReportInput& input, const std::vector<SceneReport>& scenes, const Plots& plots) {
  std::string text = "# " + markdown_cell(input.title) + "\n\n";
  for (const SceneReport& scene : scenes) {
    text += "## " + markdown_cell(scene.scene) + "\n\n";
    if (plots.contains(scene.file_stem + ".svg")) text += "![error against time](" + scene.file_stem + ".svg)\n\n";
    for (const Table& table : scene.tables) text += markdown_table(table);
  }
  return text;
}

std::string report_html(const ReportInput& input, const std::vector<SceneReport>& scenes, const Plots& plots) {
  std::string text = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>" +
                     html_text(input.title) + "</title>\n<style>" + kStyle + "</style></head>\n<body>\n<h1>" +
                     html_text(input.title) + "</h1>\n";
  for (const SceneReport& scene : scenes) {
    text += "<h2>" + html_text(scene.scene) + "</h2>\n";
    const auto plot = plots.find(scene.file_stem + ".svg");
    if (plot != plots.end()) text += figure("svg+xml", plot->second, "error against time, " + scene.scene);
    for (const Table& table : scene.tables) text += html_table(table);
  }
  return text + "</body></html>\n";
}

}  // namespace tempolux
