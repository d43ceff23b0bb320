// lib/plan/inputs.cpp -- reads and writes stamps of input files.
#include "lib/plan/inputs.h"

#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "formats/hash.h"

namespace tempolux {
namespace {

constexpr const char* kFirstLine = "tempolux inputs 1";

std::optional<InputStamp> stat_of(const std::string& path) {
  struct stat s {};
  if (::stat(path.c_str(), &s) != 0) return {};
  return InputStamp{std::uint64_t(s.st_size), std::uint64_t(s.st_ino),
                    s.st_mtim.tv_sec * 1'000'000'000LL + s.st_mtim.tv_nsec,
                    s.st_ctim.tv_sec * 1'000'000'000LL + s.st_ctim.tv_nsec, ""};
}

std::string content_hash(const std::string& path) {
  Hasher hasher;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path, error))
      names.insert(entry.path().filename().string());
    for (const std::string& name : names) hasher.add(name);
    return hasher.hex();
  }
  std::ifstream stream(path, std::ios::binary);
  std::string buffer(1 << 20, '\0');
  while (stream.read(buffer.data(), std::streamsize(buffer.size())) || stream.gcount() > 0)
    hasher.add_bytes(buffer.data(), std::size_t(stream.gcount()));
  return hasher.hex();
}

}  // namespace

bool InputStamp::same_stat(const InputStamp& other) const {
  return size == other.size && inode == other.inode && modified_ns == other.modified_ns &&
         changed_ns == other.changed_ns;
}

Inputs::Inputs(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  if (!std::getline(stream, line) || line != kFirstLine || !std::getline(stream, wish_)) return;
  InputStamp stamp;
  std::size_t length = 0;
  // Names may hold any byte except NUL, so each has its length in front.
  while (stream >> stamp.size >> stamp.inode >> stamp.modified_ns >> stamp.changed_ns >> stamp.hash >> length &&
         length < 1 << 16) {
    std::string path(length, '\0');
    stream.get();
    if (!stream.read(path.data(), std::streamsize(length))) return;
    known_[path] = stamp;
  }
}

bool Inputs::unchanged(const std::string& wish) {
  if (wish_ != wish || known_.empty()) return false;
  for (const auto& [path, stamp] : known_)
    if (hash_of(path) != stamp.hash) return false;
  return true;
}

std::string Inputs::hash_of(const std::string& path) {
  if (const auto used = used_.find(path); used != used_.end()) return used->second.hash;
  std::optional<InputStamp> now = stat_of(path);
  if (!now) return "";
  const auto known = known_.find(path);
  now->hash = known != known_.end() && known->second.same_stat(*now) ? known->second.hash : content_hash(path);
  return used_.insert_or_assign(path, *now).first->second.hash;
}

std::string Inputs::contents() const {
  Hasher hasher;
  for (const auto& [path, stamp] : used_) {
    hasher.add(path);
    hasher.add(stamp.hash);
  }
  return hasher.hex();
}

std::string Inputs::text(const std::string& wish) const {
  std::ostringstream text;
  text << kFirstLine << '\n' << wish << '\n';
  for (const auto& [path, s] : used_)
    text << s.size << ' ' << s.inode << ' ' << s.modified_ns << ' ' << s.changed_ns << ' ' << s.hash << ' '
         << path.size() << ' ' << path << '\n';
  return text.str();
}

}  // namespace tempolux
