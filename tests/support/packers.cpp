#include "tests/support/packers.h"

#include <avif/avif.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>
#include <webp/encode.h>

#include <memory>
#include <stdexcept>

namespace tempolux::test {
namespace {

draco::GeometryAttribute::Type type_of(DracoAttribute::Kind kind) {
  if (kind == DracoAttribute::Kind::position) return draco::GeometryAttribute::POSITION;
  return kind == DracoAttribute::Kind::normal ? draco::GeometryAttribute::NORMAL : draco::GeometryAttribute::TEX_COORD;
}

std::string first(const std::vector<unsigned char>& bytes, std::size_t count) {
  if (count == 0) throw std::runtime_error("nothing was packed");
  return {bytes.begin(), bytes.begin() + std::ptrdiff_t(count)};
}

}  // namespace

std::string draco_bytes(const std::vector<std::uint32_t>& indices, const std::vector<DracoAttribute>& attributes,
                        int bits) {
  draco::Mesh mesh;
  const auto points = std::uint32_t(attributes.front().values.size() / std::size_t(attributes.front().components));
  mesh.set_num_points(points);
  for (const DracoAttribute& source : attributes) {
    draco::GeometryAttribute attribute;
    attribute.Init(type_of(source.kind), nullptr, std::int8_t(source.components), draco::DT_FLOAT32, false,
                   4 * source.components, 0);
    const int id = mesh.AddAttribute(attribute, true, points);
    for (draco::PointIndex p(0); p < points; ++p)
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(p.value()),
                                            &source.values[p.value() * std::size_t(source.components)]);
    mesh.attribute(id)->set_unique_id(std::uint32_t(id));
  }
  for (std::size_t i = 0; i < indices.size(); i += 3)
    mesh.AddFace({draco::PointIndex(indices[i]), draco::PointIndex(indices[i + 1]), draco::PointIndex(indices[i + 2])});
  draco::Encoder encoder;
  encoder.SetEncodingMethod(bits == 0 ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
  for (const DracoAttribute& source : attributes)
    encoder.SetAttributeQuantization(type_of(source.kind), bits == 0 ? -1 : bits);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeMeshToBuffer(mesh, &buffer);
  if (!status.ok()) throw std::runtime_error(status.error_msg_string());
  return {buffer.data(), buffer.size()};
}

std::string meshopt_attributes(const std::string& elements, std::size_t size) {
  meshopt_encodeVertexVersion(0);
  std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(elements.size() / size, size));
  return first(bytes,
               meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), elements.data(), elements.size() / size, size));
}

std::string meshopt_indices(const std::vector<std::uint32_t>& indices) {
  meshopt_encodeIndexVersion(1);
  std::vector<unsigned char> bytes(meshopt_encodeIndexSequenceBound(indices.size(), 1u << 16));
  return first(bytes, meshopt_encodeIndexSequence(bytes.data(), bytes.size(), indices.data(), indices.size()));
}

std::string meshopt_triangles(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  meshopt_encodeIndexVersion(1);
  std::vector<unsigned char> bytes(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  return first(bytes, meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), indices.data(), indices.size()));
}

std::string octahedral_elements(const std::vector<float>& vectors) {
  std::string elements(vectors.size(), '\0');
  meshopt_encodeFilterOct(elements.data(), vectors.size() / 4, 4, 8, vectors.data());
  return elements;
}

std::string webp_bytes(int width, int height, int channels, const std::vector<std::uint8_t>& pixels) {
  std::uint8_t* bytes = nullptr;
  const auto encode = channels == 4 ? WebPEncodeLosslessRGBA : WebPEncodeLosslessRGB;
  const std::size_t count = encode(pixels.data(), width, height, width * channels, &bytes);
  std::string text(reinterpret_cast<const char*>(bytes), count);
  WebPFree(bytes);
  return text;
}

std::string avif_bytes(int width, int height, int channels, const std::vector<std::uint8_t>& pixels,
                       const AvifForm& form) {
  const auto expect_ok = [](avifResult result) {
    if (result != AVIF_RESULT_OK) throw std::runtime_error(avifResultToString(result));
  };
  const std::unique_ptr<avifImage, decltype(&avifImageDestroy)> image(
      avifImageCreate(std::uint32_t(width), std::uint32_t(height), std::uint32_t(form.depth), AVIF_PIXEL_FORMAT_YUV444),
      avifImageDestroy);
  image->matrixCoefficients = form.as_rgb ? AVIF_MATRIX_COEFFICIENTS_IDENTITY : AVIF_MATRIX_COEFFICIENTS_BT601;
  image->alphaPremultiplied = form.premultiplied ? AVIF_TRUE : AVIF_FALSE;
  if (form.quarter_turns >= 0) {
    image->transformFlags |= AVIF_TRANSFORM_IROT;
    image->irot.angle = std::uint8_t(form.quarter_turns);
  }
  if (form.mirrored) image->transformFlags |= AVIF_TRANSFORM_IMIR;
  std::vector<std::uint8_t> codes = pixels;
  avifRGBImage rgb;
  avifRGBImageSetDefaults(&rgb, image.get());
  rgb.depth = 8;
  rgb.format = channels == 4 ? AVIF_RGB_FORMAT_RGBA : AVIF_RGB_FORMAT_RGB;
  rgb.pixels = codes.data();
  rgb.rowBytes = std::uint32_t(width * channels);
  expect_ok(avifImageRGBToYUV(image.get(), &rgb));
  const std::unique_ptr<avifEncoder, decltype(&avifEncoderDestroy)> encoder(avifEncoderCreate(), avifEncoderDestroy);
  encoder->speed = AVIF_SPEED_FASTEST;
  encoder->minQuantizer = encoder->maxQuantizer = AVIF_QUANTIZER_LOSSLESS;
  encoder->minQuantizerAlpha = encoder->maxQuantizerAlpha = AVIF_QUANTIZER_LOSSLESS;
  for (int frame = 0; frame < form.frames; ++frame)
    expect_ok(avifEncoderAddImage(encoder.get(), image.get(), 1,
                                  form.frames == 1 ? AVIF_ADD_IMAGE_FLAG_SINGLE : AVIF_ADD_IMAGE_FLAG_NONE));
  avifRWData bytes = AVIF_DATA_EMPTY;
  expect_ok(avifEncoderFinish(encoder.get(), &bytes));
  std::string text(reinterpret_cast<const char*>(bytes.data), bytes.size);
  avifRWDataFree(&bytes);
  return text;
}

}  // namespace tempolux::test
