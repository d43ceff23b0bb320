// tests/bench/photons_io.cpp -- a .photons file against the bytes themselves: write() and read() of as many.
//
//     photons_io [--photons 4000000] [--block 16384] [--file /dev/shm/bench.photons]
//
// CPU seconds of one thread, the sides alternating, median of 5. Ratios above 0.5 are asked for in reading.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "formats/crc32.h"
#include "formats/photons/photons.h"

namespace {

using namespace tempolux::formats;

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

double seconds_of(const std::function<void()>& work) {
  const double start = cpu_seconds();
  work();
  return cpu_seconds() - start;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// A sink that writes to a new file.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path) : file_(::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644)) {}
  ~OutputFile() { ::close(file_); }
  void write(const void* data, std::size_t size) {
    if (::write(file_, data, size) != ssize_t(size)) std::perror("write"), std::exit(3);
  }

 private:
  int file_;
};

std::vector<PhotonBlock> make_blocks(std::size_t count, std::size_t size) {
  std::vector<PhotonBlock> blocks((count + size - 1) / size);
  std::uint32_t state = 1;
  const auto uniform = [&state] { return float((state = state * 1664525u + 1013904223u) >> 8) / 16777216.0f; };
  for (PhotonBlock& block : blocks) {
    block.photons.resize(std::min(size, count - std::size_t(&block - blocks.data()) * size));
    for (Photon& p : block.photons) {
      p.position = {uniform(), uniform(), uniform()};
      p.flux = {uniform() * 1e-6f, uniform() * 1e-6f, uniform() * 1e-6f};
      p.normal = encode_normal({uniform() - 0.5f, uniform() - 0.5f, 1.0f});
      p.object = std::uint16_t(state >> 24);
      p.kind = PathKind::indirect;
    }
  }
  return blocks;
}

void write_photons(const std::string& path, const std::vector<PhotonBlock>& blocks) {
  OutputFile file(path);
  PhotonWriter writer([&](const void* data, std::size_t size) { file.write(data, size); }, PhotonHeader());
  for (const PhotonBlock& block : blocks) writer.write(block);
  writer.finish({});
}

void write_bytes(const std::string& path, const std::vector<PhotonBlock>& blocks) {
  OutputFile file(path);
  for (const PhotonBlock& block : blocks) file.write(block.photons.data(), block.photons.size() * 32);
}

/// One read() of the whole file into memory never touched before.
void read_bytes(const std::string& path, std::size_t size) {
  void* memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  const int file = ::open(path.c_str(), O_RDONLY);
  for (std::size_t done = 0; done < size;) {
    const ssize_t got = ::read(file, static_cast<char*>(memory) + done, size - done);
    if (got <= 0) std::perror("read"), std::exit(3);
    done += std::size_t(got);
  }
  ::close(file);
  ::munmap(memory, size);
}

double crc_gb_per_s(std::uint32_t (*crc)(const void*, std::size_t, std::uint32_t)) {
  const std::vector<unsigned char> bytes(1 << 20, 17);
  std::vector<double> times;
  volatile std::uint32_t sink = 0;
  for (int i = 0; i < 5; ++i)
    times.push_back(seconds_of([&] {
      for (int k = 0; k < 200; ++k) sink = crc(bytes.data(), bytes.size(), sink);
    }));
  return 200 * double(bytes.size()) / median(times) * 1e-9;
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t count = 4000000, block = 16384;
  std::string path = "/dev/shm/photons_io." + std::to_string(::getpid()) + ".photons";
  for (int i = 1; i + 1 < argc; i += 2) {
    if (!std::strcmp(argv[i], "--photons")) count = std::strtoull(argv[i + 1], nullptr, 10);
    if (!std::strcmp(argv[i], "--block")) block = std::max(1ull, std::strtoull(argv[i + 1], nullptr, 10));
    if (!std::strcmp(argv[i], "--file")) path = argv[i + 1];
  }
  const std::vector<PhotonBlock> blocks = make_blocks(count, block);
  const double bytes = 32.0 * double(count);
  std::vector<double> write, raw_write, read, raw_read;
  for (int i = 0; i < 5; ++i) {
    raw_write.push_back(seconds_of([&] { write_bytes(path, blocks); }));
    raw_read.push_back(seconds_of([&] { read_bytes(path, 32 * count); }));
    write.push_back(seconds_of([&] { write_photons(path, blocks); }));
    read.push_back(seconds_of([&] { (void)load_photons(path); }));
  }
  ::unlink(path.c_str());
  const double raw_written = median(raw_write), written = median(write);
  const double raw_loaded = median(raw_read), loaded = median(read);
  std::printf("{\"photons\": %zu, \"block\": %zu,\n", count, block);
  std::printf(" \"write_gb_per_s\": %.3f, \"raw_write_gb_per_s\": %.3f, \"write_ratio\": %.3f,\n",
              1e-9 * bytes / written, 1e-9 * bytes / raw_written, raw_written / written);
  std::printf(" \"read_gb_per_s\": %.3f, \"raw_read_gb_per_s\": %.3f, \"read_ratio\": %.3f,\n", 1e-9 * bytes / loaded,
              1e-9 * bytes / raw_loaded, raw_loaded / loaded);
  std::printf(" \"crc_folded_gb_per_s\": %.2f, \"crc_tables_gb_per_s\": %.2f}\n",
              crc32_has_folding() ? crc_gb_per_s(crc32_folded) : 0.0, crc_gb_per_s(crc32_tables));
}
