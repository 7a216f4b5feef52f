#include "frame/io/stripe.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfTileDescription.h>

#include <algorithm>

#include "frame/io/exr_file.h"

namespace becalm::io {
namespace {

/// The number of samples in the `length` pixels from one that is a multiple of `sampling`.
std::size_t samples(int length, int sampling) {
  return (static_cast<std::size_t>(length) + sampling - 1) / sampling;
}

/// A multiple of the lines of every compression's chunks; the largest, DWAB's, have 256.
constexpr int kStripeLines = 256;

int stripe_lines(const Imf::Header& header) {
  const Imf::ChannelList& channels = header.channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    // A stripe would have to begin at a multiple of every sampling; such files are rare and small.
    if (channel.channel().ySampling != 1) return kMaxImageSide;
  }
  if (!is_tiled(header)) return kStripeLines;
  const int tile = static_cast<int>(header.tileDescription().ySize);
  return (kStripeLines + tile - 1) / tile * tile;
}

}  // namespace

std::size_t size_of(Imf::PixelType type) {
  return type == Imf::HALF ? 2 : 4;
}

const Stripe::Plane* Stripe::plane_of(const std::string& channel) const {
  const auto found = std::ranges::find(planes_, channel, &Plane::channel);
  return found == planes_.end() ? nullptr : &*found;
}

std::size_t Stripe::row_bytes(const Plane& plane) const {
  return samples(lines_.max.x - lines_.min.x + 1, plane.x_sampling) * size_of(plane.type);
}

void Stripe::copy_lines(const Stripe& from, Plane& plane) const {
  const Plane& whole = *from.plane_of(plane.channel);
  const auto first = static_cast<std::size_t>(lines_.min.y - from.lines_.min.y) / plane.y_sampling;
  std::copy_n(whole.bytes.begin() + static_cast<std::ptrdiff_t>(first * row_bytes(plane)), plane.bytes.size(),
              plane.bytes.begin());
}

void Stripe::add(std::string channel, Imf::PixelType type, int x_sampling, int y_sampling) {
  planes_.push_back({std::move(channel), type, x_sampling, y_sampling, {}});
}

void Stripe::move_to(int first, int last) {
  lines_.min.y = first;
  lines_.max.y = last;
  for (Plane& plane : planes_) {
    plane.bytes.resize(samples(lines_.max.x - lines_.min.x + 1, plane.x_sampling) *
                       samples(last - first + 1, plane.y_sampling) * size_of(plane.type));
  }
}

Imf::FrameBuffer Stripe::frame_buffer(const std::function<bool(const Plane&)>& wanted) const {
  Imf::FrameBuffer buffer;
  for (const Plane& plane : planes_) {
    if (!wanted(plane)) continue;
    buffer.insert(plane.channel, Imf::Slice::Make(plane.type, plane.bytes.data(), lines_, size_of(plane.type),
                                                  row_bytes(plane), plane.x_sampling, plane.y_sampling));
  }
  return buffer;
}

void for_each_stripe(const Imf::Header& header, const std::function<void(int first, int last)>& work) {
  const Imath::Box2i& window = header.dataWindow();
  const int lines = stripe_lines(header);
  const int count = (window.max.y - window.min.y) / lines + 1;
  for (int i = 0; i < count; ++i) {
    const int stripe = header.lineOrder() == Imf::DECREASING_Y ? count - 1 - i : i;
    const int first = window.min.y + stripe * lines;
    work(first, std::min(first + lines - 1, window.max.y));
  }
}

}  // namespace becalm::io
