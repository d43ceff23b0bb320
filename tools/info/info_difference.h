// tools/info/info_difference.h -- compares two files of one type, record by record.
#pragma once

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "tools/info/info_facts.h"

namespace tempolux::tools {

/// A file of a comparison: its header's facts, and the hash of its data.
struct ComparedFile {
  const std::string& path;
  std::string digest;
  Facts header;
};

/// The first keys of a difference: files, type, equal, and the header values that differ.
inline Facts difference_of_headers(const char* type, const ComparedFile& a, const ComparedFile& b) {
  Facts facts = {
      {"files", {a.path, b.path}}, {"type", type}, {"equal", a.digest == b.digest}, {"differing", Facts::object()}};
  for (const auto& [key, value] : a.header.items())
    if (!b.header.contains(key) || b.header[key] != value)
      facts["differing"][key] = {value, b.header.contains(key) ? b.header[key] : Facts()};
  return facts;
}

/// Number of records that both files have and that differ.
template <class Records>
std::size_t count_differing(const Records& a, const Records& b) {
  const std::size_t both = std::min(a.size(), b.size());
  std::size_t differing = 0;
  for (std::size_t i = 0; i < both; ++i) differing += !(a[i] == b[i]);
  return differing;
}

/// The numbers of compared and of differing records and, if any differ, the first one and the largest differences.
/// `light`: name and largest difference, by channel, of the records' light.
template <class Difference>
void add_record_difference(const Difference& records, const std::pair<const char*, const std::array<double, 3>&>& light,
                           Facts& facts) {
  facts["records_compared"] = records.records;
  facts["records_differing"] = records.differing;
  if (records.differing == 0) return;
  facts["first_differing_record"] = records.first;
  facts["largest_position_difference_m"] = records.largest_position;
  facts[light.first] = light.second;
}

template <class Records>
void add_differing_records(const Records& a, const Records& b, Facts& facts) {
  facts["records_compared"] = std::min(a.size(), b.size());
  facts["records_differing"] = count_differing(a, b);
}

/// The whole difference of two files that consist of a header and one array of records. The arguments read a file, and
/// select the header's facts and the records.
template <class File, class Header, class Records>
Facts difference_of_files(const char* type, const std::string& a, const std::string& b,
                          File (*load)(const std::string&), Facts (*header_facts)(const Header&),
                          Records File::*records) {
  const File file_a = load(a), file_b = load(b);
  const ComparedFile of_a{a, digest_of(file_a), header_facts(file_a.header)},
      of_b{b, digest_of(file_b), header_facts(file_b.header)};
  Facts facts = difference_of_headers(type, of_a, of_b);
  add_differing_records(file_a.*records, file_b.*records, facts);
  facts["digests"] = {of_a.digest, of_b.digest};
  return facts;
}

}  // namespace tempolux::tools
