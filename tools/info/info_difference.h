// tools/info/info_difference.h -- what the differences of two files of one type, record by record, have in common.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/info/info_facts.h"

namespace tempolux::tools {

/// A file that is compared: what its header says, and the hash of its data.
struct ComparedFile {
  const std::string& path;
  std::string digest;
  Facts header;
};

/// The keys that come first: files, type, equal, and the headers' values that differ.
inline Facts difference_of_headers(const char* type, const ComparedFile& a, const ComparedFile& b) {
  Facts facts = {
      {"files", {a.path, b.path}}, {"type", type}, {"equal", a.digest == b.digest}, {"differing", Facts::object()}};
  for (const auto& [key, value] : a.header.items())
    if (!b.header.contains(key) || b.header[key] != value)
      facts["differing"][key] = {value, b.header.contains(key) ? b.header[key] : Facts()};
  return facts;
}

/// Of the records that both have, by number: those that differ.
template <class Records>
std::size_t count_differing(const Records& a, const Records& b) {
  const std::size_t both = std::min(a.size(), b.size());
  std::size_t differing = 0;
  for (std::size_t i = 0; i < both; ++i) differing += !(a[i] == b[i]);
  return differing;
}

template <class Records>
void add_differing_records(const Records& a, const Records& b, Facts& facts) {
  facts["records_compared"] = std::min(a.size(), b.size());
  facts["records_differing"] = count_differing(a, b);
}

/// All of it for files that are a header and one array of records: how they are read, what of a header is compared,
/// where the records are.
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
