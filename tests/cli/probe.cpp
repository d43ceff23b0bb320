// tool-probe -- what all tools share, and nothing else: the subject of the scripts in this folder.
//
//     tool-probe room.glb --frames 0-3 --size 8MiB -o f.####.out
//
// WORK says what happens on the way: "write" the file slowly or fast (--pause), or fail in a given manner.
#include <unistd.h>
#include <xmmintrin.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "formats/error.h"
#include "tools/common/tool_main.h"

using namespace tempolux;

namespace {

/// Fails as `work` says, or returns.
void fail_as(const std::string& work) {
  if (work == "input-error") throw InputError("room.glb: node 3 \"La\nmp\": bad; mend it");
  if (work == "caller-error") throw std::invalid_argument("size: must be positive");
  if (work == "resource-error") throw ResourceError("disk: gone");
  if (work == "system-error") throw std::system_error(EIO, std::generic_category(), "disk");
  if (work == "other-error") throw std::runtime_error("odd");
  if (work == "memory") {
    std::vector<std::unique_ptr<char[]>> blocks;
    while (blocks.size() < 4096) {  // 4 GiB at most, should the limit not hold
      blocks.push_back(std::make_unique<char[]>(1 << 20));
      blocks.back()[0] = 1;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("tool-probe", "Do what all tools share, and nothing else.", argc, argv);
  std::string scene, work = "write", output, second;
  std::uint64_t bytes = 1 << 20;
  unsigned pause_us = 0;
  tool.app().add_option("scene", scene, "a name; not opened")->required();
  tool.app().add_option("--work", work, "write, or how to fail")->capture_default_str();
  tool.app().add_option("--pause", pause_us, "microseconds to sleep before each 64 KiB")->capture_default_str();
  tool.output_option(output, "the file to write")->required();
  tool.output_option(second, "another file to write", "--second");
  tool.bytes_option("--bytes", bytes, "size of the files");
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_frames | tools::uses_camera);

  return tool.run([&] {
    const bool range = tool.common().frames.size() > 1;
    tool.depends_on(scene);
    tool.depends_on("cache.points");
    for (const int frame : tool.common().frames) {
      tools::Output file(range ? tools::frame_name(output, frame) : output);
      std::optional<tools::Output> other;
      if (!second.empty()) other.emplace(second);
      fail_as(work);
      tool.stats().phase("write", true);
      file.write(tool.history_line(frame));
      const std::string block(1 << 16, 'x');
      for (std::uint64_t written = 0; written < bytes; written += block.size()) {
        if (pause_us) usleep(pause_us);
        file.write(block.data(), block.size());
        tool.progress(double(written) / double(bytes));
      }
      file.write("\nend\n");
      if (other) {
        other->write("other end\n");
        other->commit();
      }
      file.commit();
      tool.stats().count("bytes", double(bytes));
    }
    tool.stats().set("flush_to_zero", double((_mm_getcsr() >> 15) & 1));
    tool.say("done");
    return tools::exit_ok;
  });
}
