#include "tools/stages/split_files.h"

#include <filesystem>
#include <vector>

#include "formats/error.h"
#include "tools/common/file_head.h"

namespace tempolux::tools {
namespace {

/// The two outputs, created before the work.
struct Outputs {
  Output low, high;
};

void count_cells(Tool& tool, const FluxCells& cells, double edge) {
  tool.stats().count("cells", double(cells.size()));
  tool.stats().count("bright_cells", double(cells.bright_count()));
  tool.stats().set("cell_edge_m", edge);
  tool.stats().set("area_m2", cells.area());
  tool.stats().set("mean_irradiance_W_m2", cells.mean_irradiance());
}

/// Reads photons in as many passes as needed. Photons from a pipe are stored in a temporary file next to the low part.
class PhotonFile {
 public:
  PhotonFile(Tool& tool, std::string path, const SplitOptions& options) : tool_(tool), path_(std::move(path)) {
    if (path_ == "-") spool(options.low);
  }
  template <class Each>
  void read(const char* phase, const Each& each) {
    tool_.stats().phase(phase);
    formats::PhotonReader reader(path_, {.digest = false});
    read_all(reader, each);
  }
  const formats::PhotonHeader& header() const { return header_; }
  const formats::PhotonTotals& totals() const { return totals_; }
  const std::vector<formats::GroupFlux>& ledger() const { return ledger_; }

 private:
  template <class Each>
  void read_all(formats::PhotonReader& reader, const Each& each) {
    header_ = reader.header();
    const double expected = double(reader.photon_count_bound());
    double done = 0;
    formats::PhotonBlock block;
    while (reader.read_block(block)) {
      each(block);
      done += double(block.photons.size());
      if (expected > 0) tool_.progress(done / expected);
    }
    totals_ = reader.totals();
    ledger_ = reader.ledger();
  }
  /// Writes the whole map from standard input to a temporary file, which this object removes at its end.
  void spool(const std::string& low) {
    tool_.stats().phase("spool");
    const std::filesystem::path beside(low);
    const bool in_folder = low != "-" && (!std::filesystem::exists(beside) || std::filesystem::is_regular_file(beside));
    spool_.emplace(((in_folder ? beside.parent_path() : std::filesystem::path()) / "photonmap-split.spool").string());
    formats::PhotonReader reader("-", {.digest = false});
    formats::PhotonHeader whole = reader.header();
    whole.base_name.clear(), whole.base_digest.clear();
    formats::PhotonWriter writer(spool_->sink(), whole);
    read_all(reader, [&](const formats::PhotonBlock& block) { writer.write(block); });
    writer.finish(totals_, ledger_);
    spool_->flush();
    path_ = spool_->temporary_path();
  }

  Tool& tool_;
  std::string path_;
  std::optional<Output> spool_;
  formats::PhotonHeader header_;
  formats::PhotonTotals totals_;
  std::vector<formats::GroupFlux> ledger_;
};

/// The header of a part: with this tool's history, and without the base of an overlay.
formats::PhotonHeader part_header(const Tool& tool, formats::PhotonHeader header, const std::string& part) {
  header.history += tool.history_line();
  header.base_name.clear(), header.base_digest.clear();
  header.part = part;
  return header;
}

void refuse_part(const std::string& file, const std::string& part) {
  if (!part.empty())
    throw InputError(file + ": holds the " + part + " part of the light alone; give the file that it was divided from");
}

void split_photons(Tool& tool, const std::string& path, const SplitOptions& options, Outputs& outputs) {
  PhotonFile file(tool, path, options);
  std::optional<double> edge = options.cell;
  if (!edge) {
    CellEdge found;
    file.read("cell size", [&](const formats::PhotonBlock& block) {
      for (const formats::Photon& photon : block.photons) found.add(place_of(photon).position);
    });
    edge = found.edge();
  }
  FluxCells cells(*edge, 0);
  file.read("cells", [&](const formats::PhotonBlock& block) { add_flux(block, cells); });
  refuse_part(options.input, file.header().part);
  cells.close(options.limit);
  formats::PhotonWriter low(outputs.low.sink(), part_header(tool, file.header(), "low"));
  formats::PhotonWriter high(outputs.high.sink(), part_header(tool, file.header(), "high"));
  file.read("divide", [&](const formats::PhotonBlock& block) {
    const auto parts = divide(block, cells);
    low.write(parts.low);
    high.write(parts.high);
  });
  const formats::PhotonTotals low_totals = low.finish(file.totals(), file.ledger());
  const formats::PhotonTotals high_totals = high.finish(file.totals(), file.ledger());
  count_cells(tool, cells, *edge);
  tool.stats().count("low", double(low_totals.photon_count));
  tool.stats().count("high", double(high_totals.photon_count));
}

void split_points(Tool& tool, const std::string& path, const SplitOptions& options, Outputs& outputs) {
  tool.stats().phase("read");
  formats::IrradpointsFile file = formats::load_irradpoints(path);
  refuse_part(options.input, file.header.part);
  tool.stats().phase("cells");
  const double spacing = file.header.spacing;
  // Points are evenly spaced: a square of four spacings holds 4 x 4 of them.
  const double edge = options.cell.value_or(options.spacings_per_cell * spacing);
  FluxCells cells(edge, spacing * spacing);
  add_flux(file.records, spacing * spacing, cells);
  cells.close(options.limit);
  tool.stats().phase("divide");
  const auto parts = divide(file.records, cells);
  const auto write = [&](Output& output, const char* part, const std::vector<formats::IrradiancePointRecord>& points) {
    formats::IrradpointsHeader header = file.header;
    header.history += tool.history_line();
    header.part = part;
    formats::IrradpointsWriter writer(output.sink(), header);
    writer.write(points);
    writer.finish();
  };
  write(outputs.low, "low", parts.low);
  write(outputs.high, "high", parts.high);
  count_cells(tool, cells, edge);
  tool.stats().count("low", double(parts.low.size()));
  tool.stats().count("high", double(parts.high.size()));
}

}  // namespace

void split_file(Tool& tool, const SplitOptions& options) {
  const std::string path = readable_name(options.input);
  tool.depends_on(options.input);
  const std::string head = head_of(path);
  const bool points = head.starts_with("\x89TIRPT");
  if (!points && !head.starts_with("\x89TPHOT"))
    throw InputError(options.input +
                     ": holds neither photons nor irradiance points; give a .photons or .irradpoints file");
  Outputs outputs{Output(options.low), Output(options.high)};
  (points ? split_points : split_photons)(tool, path, options, outputs);
  tool.stats().phase("commit");
  outputs.low.commit();
  outputs.high.commit();
  tool.stats().end_phase();
}

}  // namespace tempolux::tools
