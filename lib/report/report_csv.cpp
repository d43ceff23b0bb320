// lib/report/report_csv.cpp -- writes every run as a line of comma-separated values.
#include <algorithm>

#include "lib/report/scene_report.h"
#include "lib/report/text.h"

namespace tempolux {
namespace {

/// RFC 4180: quotes the text if needed, and doubles quotes.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) line += (i ? "," : "") + csv_cell(cells[i]);
  return line + "\n";
}

/// Named numbers of a run in order of appearance: seconds by phase, then counts. Equal names are added up.
using Columns = std::vector<std::pair<std::string, double>>;

void add_to(Columns& columns, const std::string& name, double value) {
  const auto found = std::ranges::find(columns, name, &std::pair<std::string, double>::first);
  if (found != columns.end()) found->second += value;
  else columns.emplace_back(name, value);
}

Columns phases_of(const MeasuredRun& run) {
  Columns columns;
  for (const StatsRecord& stage : run.stages)
    for (const StatsRecord::Phase& phase : stage.phases)
      add_to(columns, stage.tool + "." + phase.name + " cpu_s", phase.cpu_s);
  return columns;
}

Columns counts_of(const MeasuredRun& run) {
  Columns columns;
  for (const StatsRecord& stage : run.stages)
    for (const auto& [name, value] : stage.counts) add_to(columns, stage.tool + "." + name, value);
  return columns;
}

std::string joined(const MeasuredRun& run, bool stages) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : " ") + part; };
  if (stages)
    for (const StatsRecord& stage : run.stages) add(stage.tool);
  else
    for (const auto& [key, value] : run.parameters) add(key + "=" + value);
  return text;
}

std::vector<std::string> error_cells(const std::optional<ErrorRecord>& error) {
  constexpr const char* kExact = "%.9g";
  if (!error) return std::vector<std::string>(12);
  const auto& worst = error->worst_object;
  return {error->layer,
          number_text(error->pixels, "%.0f"),
          std::to_string(error->frames),
          number_text(error->rmse(), kExact),
          number_text(error->mse, kExact),
          number_text(error->mse_standard_error, kExact),
          number_text(error->relmse, kExact),
          number_text(error->bias, kExact),
          number_text(error->bias_standard_error, kExact),
          worst ? number_text(worst->bias, kExact) : "",
          number_text(error->psnr_db, kExact),
          number_text(error->flicker, kExact)};
}

}  // namespace

std::string report_csv(const ReportInput& input) {
  std::vector<std::string> numbers;
  for (const auto columns_of : {phases_of, counts_of})
    for (const MeasuredRun& run : input.runs)
      for (const auto& [name, value] : columns_of(run))
        if (std::ranges::find(numbers, name) == numbers.end()) numbers.push_back(name);

  std::vector<std::string> header{
      "scene", "curve", "label", "x", "parameters", "stages", "cpu_s", "wall_s", "peak_memory_bytes"};
  header.insert(header.end(), numbers.begin(), numbers.end());
  for (const char* name : {"layer", "pixels", "frames", "rmse", "mse", "mse_standard_error", "relmse", "bias",
                           "bias_standard_error", "worst_object_bias", "psnr_db", "flicker"})
    header.push_back(name);
  std::string text = csv_line(header);
  for (const MeasuredRun& run : input.runs) {
    std::vector<std::string> cells{run.scene,
                                   run.curve,
                                   run.label,
                                   number_text(run.x, "%.9g"),
                                   joined(run, false),
                                   joined(run, true),
                                   number_text(run.cpu_s(), "%.6f"),
                                   number_text(run.wall_s(), "%.6f"),
                                   number_text(run.peak_memory_bytes(), "%.0f")};
    Columns columns = phases_of(run);
    for (auto& column : counts_of(run)) columns.push_back(std::move(column));
    for (const std::string& name : numbers) {
      const auto found = std::ranges::find(columns, name, &std::pair<std::string, double>::first);
      cells.push_back(found == columns.end() ? "" : number_text(found->second, "%.9g"));
    }
    for (std::string& cell : error_cells(run.error)) cells.push_back(std::move(cell));
    text += csv_line(cells);
  }
  return text;
}

}  // namespace tempolux
