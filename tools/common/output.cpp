#include "tools/common/output.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "formats/error.h"
#include "formats/hash.h"
#include "tools/common/temporaries.h"

namespace tempolux::tools {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
/// Pieces of at least this size are written without copying.
constexpr std::size_t kDirectBytes = std::size_t{1} << 14;

/// ".NAME.tmp.HOST." in the folder of `target`; a name too long for the file system is shortened and hashed.
std::filesystem::path temporary_stem(const std::filesystem::path& target, const std::string& host) {
  std::string name = target.filename().string();
  constexpr std::size_t kDigits = 20;  // digits of the longest process id
  const std::size_t rest = std::strlen("..tmp..") + host.size() + kDigits;
  if (name.size() + rest > NAME_MAX) name = name.substr(0, 64) + "~" + hash_hex(name);
  return target.parent_path() / ("." + name + ".tmp." + host + ".");
}

/// Temporary files in a folder when this process first listed it. Listed once, since the time would otherwise grow with
/// the square of the number of outputs.
const std::vector<std::string>& temporaries_found(const std::string& folder) {
  static std::mutex mutex;
  static std::map<std::string, std::vector<std::string>> found;
  const std::lock_guard lock(mutex);
  const auto [entry, is_new] = found.try_emplace(folder);
  DIR* listing = is_new ? opendir(folder.c_str()) : nullptr;
  if (!listing) return entry->second;
  while (const dirent* item = readdir(listing))
    if (item->d_name[0] == '.' && std::strstr(item->d_name, ".tmp.")) entry->second.emplace_back(item->d_name);
  closedir(listing);
  return entry->second;
}

/// Removes temporary files that killed runs have left for the same target: files of this host, whose process does not
/// exist and whose lock is free.
void remove_stale(const std::filesystem::path& stem) {
  const std::string folder = stem.has_parent_path() ? stem.parent_path().string() : ".";
  const std::string prefix = stem.filename().string();
  for (const std::string& name : temporaries_found(folder)) {
    if (!name.starts_with(prefix) || name.size() == prefix.size()) continue;
    const std::string digits = name.substr(prefix.size());
    if (digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) continue;
    const pid_t process = pid_t(std::stol(digits));
    if (process == getpid() || process == 0 || kill(process, 0) == 0 || errno != ESRCH) continue;
    const std::string path = folder + "/" + name;
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) continue;
    if (flock(file, LOCK_EX | LOCK_NB) == 0) unlink(path.c_str());
    close(file);
  }
}

std::string reason_and_remedy(int error) {
  const std::string reason = std::strerror(error);
  switch (error) {
    case ENOSPC:
    case EDQUOT: return reason + "; free space there or choose another folder";
    case EFBIG: return reason + "; raise the limit of file sizes (ulimit -f)";
    case EPIPE: return reason + "; the reader of the pipe ended early";
    case EROFS:
    case EACCES:
    case EPERM: return reason + "; choose a folder that can be written";
    case ENOENT:
    case ENOTDIR: return reason + "; make the folder first";
    default: return reason;
  }
}

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
  const std::string name = path == "-" ? "standard output" : path;
  throw ResourceError(name + ": " + what + ": " + reason_and_remedy(error));
}

/// Identifies a file independent of its name.
using FileId = std::pair<dev_t, ino_t>;

std::optional<FileId> regular_file(const std::string& path) {
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return FileId{status.st_dev, status.st_ino};
}

/// All files that this process reads, writes and has written: for the dependency file, for messages, and to detect two
/// outputs with one name, or an output that would replace an input.
struct Ledger {
  struct Line {
    std::string path, target, temporary;
    std::string key;  ///< the target's path in normal form
    std::optional<FileId> replaces;
    enum class Stage { open, committed, dropped } stage = Stage::open;
  };
  std::mutex mutex;
  std::vector<Line> lines;
  std::set<std::string> open_keys;               ///< of the outputs under construction
  std::map<FileId, std::string> to_be_replaced;  ///< files that these outputs will replace, and their temporary files
  std::map<FileId, std::string> inputs;          ///< input files and their names

  /// Checked when needed, since a removed file's id may be given to another file.
  void refuse_input(const FileId& id, const std::string& output) const {
    const auto input = inputs.find(id);
    if (input != inputs.end() && regular_file(input->second) == id)
      throw InputError(output + ": this run reads it" + (input->second == output ? "" : ", as " + input->second) +
                       "; give the output another name");
  }
};

Ledger& ledger() {
  static Ledger instance;
  return instance;
}

}  // namespace

struct Output::State {
  std::string path, target, temporary_path;
  int file = -1;
  std::optional<Temporary> temporary;  ///< empty: the output is written in place
  std::vector<char> buffer;
  std::size_t ledger_line = 0;
  std::uint64_t bytes_written = 0;

  explicit State(std::string name) : path(std::move(name)) {}
  ~State() {
    if (file > STDERR_FILENO) close(file);
    note(Ledger::Line::Stage::dropped);
  }

  void note(Ledger::Line::Stage stage) {
    const std::lock_guard lock(ledger().mutex);
    if (ledger_line >= ledger().lines.size()) return;
    Ledger::Line& line = ledger().lines[ledger_line];
    if (line.stage != Ledger::Line::Stage::open) return;
    line.stage = stage;
    ledger().open_keys.erase(line.key);
    if (line.replaces) ledger().to_be_replaced.erase(*line.replaces);
  }
  void enter_in_ledger() {
    std::error_code unknown;
    const std::filesystem::path whole = std::filesystem::absolute(target, unknown);
    const std::string key = target == "-" ? "-" : std::filesystem::weakly_canonical(whole, unknown).string();
    const std::lock_guard lock(ledger().mutex);
    const std::optional<FileId> replaces = target == "-" ? std::nullopt : regular_file(target);
    if (replaces) ledger().refuse_input(*replaces, path);
    if (!ledger().open_keys.insert(key).second)
      throw InputError(path + ": named for two outputs; give them different names");
    if (replaces) ledger().to_be_replaced.emplace(*replaces, path);
    ledger_line = ledger().lines.size();
    ledger().lines.push_back({path, target, temporary_path, key, replaces});
  }

  void open_output(Kind kind) {
    if (path.empty()) throw InputError("an output has no name; give one with -o");
    if (path == "-") return open_stdout(kind);
    target = path;
    struct stat status = {};
    if (stat(path.c_str(), &status) != 0) return open_temporary({});
    if (S_ISDIR(status.st_mode)) throw InputError(path + ": is a folder; name a file");
    // /dev/stdout may lead to a file that other processes hold open; /dev/shm is a folder of files like any other.
    const bool of_the_system =
        (path.starts_with("/dev/") && !path.starts_with("/dev/shm/")) || path.starts_with("/proc/");
    if (!S_ISREG(status.st_mode) || of_the_system) return open_in_place();
    if (access(path.c_str(), W_OK) != 0) fail(path, "cannot write", errno);
    if (std::filesystem::is_symlink(path)) target = std::filesystem::canonical(path).string();
    open_temporary(status.st_mode & 0777);
  }
  void open_stdout(Kind kind) {
    if (kind == Kind::binary && isatty(STDOUT_FILENO))
      throw InputError("standard output is a terminal; send it to a file or a pipe, or name a file with -o");
    target = "-";
    temporary_path = "/dev/stdout";
    enter_in_ledger();
    file = STDOUT_FILENO;
  }
  void open_in_place() {
    temporary_path = target;
    enter_in_ledger();
    file = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) fail(path, "cannot write", errno);
  }
  void open_temporary(std::optional<mode_t> mode) {
    const std::filesystem::path stem = temporary_stem(target, host_name());
    temporary_path = stem.string() + std::to_string(getpid());
    enter_in_ledger();
    remove_stale(stem);
    unlink(temporary_path.c_str());  // left by a dead process with the same id
    temporary.emplace(temporary_path);
    file = open(temporary_path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0) {
      const int error = errno;
      temporary->release();
      fail(path, "cannot create", error);
    }
    // Shows other processes that this one is running; not every file system supports locks.
    flock(file, LOCK_EX | LOCK_NB);
    if (mode) fchmod(file, *mode);
  }

  void flush_buffer() {
    write_all(buffer.data(), buffer.size());
    buffer.clear();
  }
  void write_all(const char* data, std::size_t size) {
    while (size > 0) {
      const ssize_t written = ::write(file, data, size);
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(path, "write failed", errno);
      data += written;
      size -= std::size_t(written);
    }
  }
  void put(const char* data, std::size_t size) {
    if (file < 0) throw std::logic_error(path + ": written after commit");
    if (buffer.size() + size > kBufferBytes || size >= kDirectBytes) flush_buffer();
    if (size >= kDirectBytes) return write_all(data, size);
    if (buffer.capacity() == 0) buffer.reserve(kBufferBytes);
    buffer.insert(buffer.end(), data, data + size);
  }

  void commit(bool sync) {
    finish_file(sync);
    if (temporary) rename_into_place(sync);
    note(Ledger::Line::Stage::committed);
  }

  /// Writes all bytes (with `sync` to the disk) and closes the file.
  void finish_file(bool sync) {
    flush_buffer();
    if (sync && fsync(file) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS)
      fail(path, "write failed", errno);
    const int closed = file > STDERR_FILENO ? close(file) : 0;
    file = -1;
    if (closed != 0) fail(path, "write failed", errno);
  }
  void rename_into_place(bool sync) {
    if (rename(temporary->path(), target.c_str()) != 0) fail(path, "cannot rename the finished file", errno);
    temporary->release();
    if (!sync) return;
    const std::string folder = std::filesystem::path(target).parent_path().string();
    const int handle = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle < 0) return;  // the folder may be writable but not readable
    fsync(handle);
    close(handle);
  }
};

void protect_input(const std::string& path) {
  const std::optional<FileId> id = regular_file(path);
  if (!id) return;
  const std::lock_guard lock(ledger().mutex);
  ledger().inputs.emplace(*id, path);
  const auto output = ledger().to_be_replaced.find(*id);
  if (output != ledger().to_be_replaced.end()) ledger().refuse_input(*id, output->second);
}

std::string host_name() {
  char name[HOST_NAME_MAX + 1] = "host";
  gethostname(name, sizeof name - 1);
  std::string host = name;
  std::ranges::replace(host, '/', '_');
  return host;
}

Output::Output(const std::string& path, Kind kind) : state_(std::make_unique<State>(path)) {
  state_->open_output(kind);
}

Output::~Output() = default;
Output::Output(Output&&) noexcept = default;
Output& Output::operator=(Output&&) noexcept = default;

const std::string& Output::path() const { return state_->path; }
const std::string& Output::temporary_path() const { return state_->temporary_path; }
bool Output::is_stdout() const { return state_->path == "-"; }
void Output::flush() { state_->flush_buffer(); }

void Output::write(const void* data, std::size_t size) {
  state_->put(static_cast<const char*>(data), size);
  state_->bytes_written += size;
}
std::function<void(const void*, std::size_t)> Output::sink() {
  return [this](const void* data, std::size_t size) { write(data, size); };
}
std::uint64_t Output::written() const { return state_->bytes_written; }

void Output::commit() { state_->commit(true); }
void Output::commit_unsynced() { state_->commit(false); }

std::vector<std::string> committed_outputs() {
  const std::lock_guard lock(ledger().mutex);
  std::vector<std::string> paths;
  for (const Ledger::Line& line : ledger().lines)
    if (line.stage == Ledger::Line::Stage::committed && line.target != "-") paths.push_back(line.path);
  return paths;
}

std::string with_final_names(std::string message) {
  const std::lock_guard lock(ledger().mutex);
  for (const Ledger::Line& line : ledger().lines) {
    if (line.temporary.empty() || line.temporary == line.target || line.target == "-") continue;
    for (std::size_t at; (at = message.find(line.temporary)) != std::string::npos;)
      message.replace(at, line.temporary.size(), line.path);
  }
  return message;
}

}  // namespace tempolux::tools
