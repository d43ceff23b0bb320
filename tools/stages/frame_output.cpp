#include "tools/stages/frame_output.h"

#include <utility>

#include "lib/image/object_names.h"

namespace tempolux::tools {
namespace {

/// Objects whose names the frame stores: those in id.object, and those that the account names.
std::set<std::uint32_t> objects_of(const Image& data, const FrameDescription& description) {
  std::set<std::uint32_t> objects;
  if (const Channel* ids = data.find("id.object")) objects.insert(ids->ids.begin(), ids->ids.end());
  for (const auto& [name, value] : description.account)
    if (name.ends_with("worst_object_id")) objects.insert(std::uint32_t(value));
  return objects;
}

}  // namespace

FrameOutputs::FrameOutputs(const std::string& path, bool halves) {
  outputs_.emplace_back(path);
  if (!halves) return;
  for (const char* half : {"_a", "_b"}) outputs_.emplace_back(name_with(path, half));
}

void FrameOutputs::write(const RenderedFrame& rendered, Image data, const FrameDescription& description,
                         const KeptPixels& kept) {
  const std::size_t data_channels = data.channels.size();
  const std::set<std::uint32_t> objects = objects_of(data, description);
  const LayerImage* parts[3] = {&rendered.mean, &rendered.half[0], &rendered.half[1]};
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    Image image = i + 1 < outputs_.size() ? data : std::move(data);
    add_colour_channels(*parts[i], description.channels, image);
    if (!kept.anew.empty()) keep_base_pixels(kept.anew, kept.from, data_channels, image);
    if (kept.change) add_change(*kept.change, image);
    describe_frame(image, description.identity, description.frame, description.fps, description.history,
                   description.camera);
    image.numbers["tempolux:samples"] = parts[i]->samples;
    set_object_names(image, objects, description.object_names);
    if (i == 0)  // of the mean of all samples
      for (const auto& [name, value] : description.account) image.numbers["tempolux:" + name] = value;
    save_exr(outputs_[i].temporary_path(), image, description.exr);
  }
  for (Output& output : outputs_) output.commit();
}

}  // namespace tempolux::tools
