#include "filter/gpu/chain.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <limits>

#include "filter/gpu/chain_impl.h"

namespace becalm::gpu {

Chain::Impl::~Impl() {
  if (*device.device == vk::Device()) return;
  try {
    device.device.waitIdle();  // a failed run may still use objects that are about to be destroyed
  } catch (const vk::SystemError&) {
    // A lost device no longer uses any object.
  }
}

std::string Chain::Impl::label(std::size_t pass) const {
  return label() + ": pass " + std::to_string(pass) + " '" + passes[pass].name + "'";
}

void Chain::Impl::require_declaring() const {
  if (is_planned) throw DeviceError(label() + ": is built already, nothing can be declared any more");
}

ImageId Chain::Impl::declare(std::string image_name, Format format, Extent extent, Role role) {
  require_declaring();
  const std::string where = label() + ": image '" + image_name + "': ";
  if (extent.width < 1 || extent.height < 1 || extent.planes < 1) {
    throw DeviceError(where + "width, height and planes must be positive, not " +
                      std::to_string(extent.width) + "x" + std::to_string(extent.height) + "x" +
                      std::to_string(extent.planes));
  }
  if (std::ranges::find(images, image_name, &ImageDeclaration::name) != images.end()) {
    throw DeviceError(where + "is declared twice");
  }
  images.push_back({std::move(image_name), format, extent, role});
  return {static_cast<int>(images.size()) - 1};
}

const ImageDeclaration& Chain::Impl::image(ImageId id) const {
  if (id.index < 0 || static_cast<std::size_t>(id.index) >= images.size()) {
    throw DeviceError(label() + ": image id " + std::to_string(id.index) + " is not of this chain");
  }
  return images[static_cast<std::size_t>(id.index)];
}

Chain::Chain(Device& device, std::string name, const ChainOptions& options)
    : impl_(std::make_unique<Impl>(device, std::move(name), options)) {}

Chain::~Chain() = default;

Chain::Chain(Chain&&) noexcept = default;

ImageId Chain::image(std::string name, Format format, Extent extent) {
  return impl_->declare(std::move(name), format, extent, Role::transient);
}

ImageId Chain::input(std::string name, Format format, Extent extent) {
  return impl_->declare(std::move(name), format, extent, Role::input);
}

ImageId Chain::table(std::string name, Format format, Extent extent) {
  const ImageId id = input(std::move(name), format, extent);
  impl_->images[static_cast<std::size_t>(id.index)].is_table = true;
  return id;
}

History Chain::history(const std::string& name, Format format, Extent extent) {
  const History result{impl_->declare(name + ".prev", format, extent, Role::history_previous),
                       impl_->declare(name + ".next", format, extent, Role::history_next)};
  impl_->images[static_cast<std::size_t>(result.previous.index)].partner = result.next.index;
  impl_->images[static_cast<std::size_t>(result.next.index)].partner = result.previous.index;
  impl_->has_history = true;
  return result;
}

void Chain::output(ImageId image, int pixel_px) {
  impl_->require_declaring();
  static_cast<void>(impl_->image(image));
  ImageDeclaration& declared = impl_->images[static_cast<std::size_t>(image.index)];
  declared.is_output = true;
  declared.pixel_px = pixel_px;
}

Chain::Pass Chain::pass(std::string_view kernel) {
  impl_->require_declaring();
  impl_->passes.emplace_back().name = kernel;
  return {*this, impl_->passes.size() - 1};
}

Chain::HostPass Chain::host_pass(std::string name) {
  impl_->require_declaring();
  PassDeclaration& pass = impl_->passes.emplace_back();
  pass.name = std::move(name);
  pass.kind = PassKind::host;
  impl_->has_host_passes = true;
  return {*this, impl_->passes.size() - 1};
}

void Chain::fill(ImageId image, float value) {
  impl_->require_declaring();
  PassDeclaration& pass = impl_->passes.emplace_back();
  pass.name = "fill";
  pass.kind = PassKind::fill;
  pass.fill_bits = std::bit_cast<std::uint32_t>(value);
  pass.uses.push_back({"", image.index, Access::write});
}

Chain::HostPass& Chain::HostPass::read(ImageId image, const Footprint& footprint) {
  chain_.impl_->passes[index_].uses.push_back({"", image.index, Access::read, footprint});
  return *this;
}

Chain::HostPass& Chain::HostPass::write(ImageId image) {
  chain_.impl_->passes[index_].uses.push_back({"", image.index, Access::write});
  return *this;
}

void Chain::HostPass::run(std::function<void(const HostImages&)> work) {
  chain_.impl_->require_declaring();
  chain_.impl_->passes[index_].work = std::move(work);
}

std::span<std::byte> Chain::HostImages::bytes(ImageId image, bool writes) const {
  for (const Use& use : chain_.passes[pass_].uses) {
    if (use.image != image.index || use.writes() != writes) continue;
    return {chain_.buffer(use.image, chain_.parity).mapped, chain_.image(image).bytes()};
  }
  throw DeviceError(chain_.label(pass_) + ": image '" + chain_.image(image).name +
                    "' is not declared to be " + (writes ? "written" : "read"));
}

const DeviceInfo& Chain::device() const {
  return impl_->device.info;
}

Chain::Pass& Chain::Pass::read(std::string_view binding, std::optional<ImageId> image,
                               const Footprint& footprint) {
  PassDeclaration& pass = chain_.impl_->passes[index_];
  if (image) {
    pass.uses.push_back({std::string(binding), image->index, Access::read, footprint});
  } else {
    pass.absent.emplace_back(binding);
  }
  return *this;
}

Chain::Pass& Chain::Pass::write(std::string_view binding, std::optional<ImageId> image) {
  PassDeclaration& pass = chain_.impl_->passes[index_];
  if (image) {
    pass.uses.push_back({std::string(binding), image->index, Access::write});
  } else {
    pass.absent.emplace_back(binding);
  }
  return *this;
}

Chain::Pass& Chain::Pass::write_plane(std::string_view binding, ImageId image, int plane) {
  chain_.impl_->passes[index_].uses.push_back({std::string(binding), image.index, Access::write, {}, plane});
  return *this;
}

Chain::Pass& Chain::Pass::read_write(std::string_view binding, ImageId image) {
  chain_.impl_->passes[index_].uses.push_back({std::string(binding), image.index, Access::read_write});
  return *this;
}

Chain::Pass& Chain::Pass::constant_bytes(std::span<const std::byte> bytes) {
  chain_.impl_->passes[index_].constants.assign(bytes.begin(), bytes.end());
  return *this;
}

Chain::Pass& Chain::Pass::specialize(std::string_view constant, std::int32_t value) {
  chain_.impl_->passes[index_].specializations.emplace_back(constant, value);
  return *this;
}

void Chain::Pass::dispatch(Extent extent) {
  chain_.impl_->require_declaring();
  chain_.impl_->passes[index_].extent = extent;
}

void Chain::plan() {
  Impl& s = *impl_;
  s.require_declaring();
  s.check();
  guarded(s.label(), [&] {
    s.plan_steps();
    s.plan_segments();
    s.plan_memory();
  });
  s.is_planned = true;
}

void Chain::build() {
  Impl& s = *impl_;
  if (s.is_built) throw DeviceError(s.label() + ": is built already");
  if (!s.is_planned) plan();
  guarded(s.label(), [&] {
    s.allocate();
    s.create_staging();
    s.create_pipelines();
    s.create_nothing();
    s.declare_times();
  });
  s.device.check_validation(s.label());
  s.is_built = true;
}

std::span<std::byte> Chain::upload_bytes(ImageId image) {
  Impl& s = *impl_;
  const ImageDeclaration& declared = s.image(image);
  const std::string where = s.label() + ": upload of '" + declared.name + "': ";
  if (declared.role != Role::input) throw DeviceError(where + "it is not an input");
  if (!s.is_built) throw DeviceError(where + "the chain is not built yet");
  const auto index = static_cast<std::size_t>(image.index);
  if (!declared.is_table) {
    s.take_scratch();
    s.holds_outputs = false;
  }
  s.is_filled[index] = true;
  if (s.is_in_place()) return {s.buffers[index].mapped, declared.bytes()};
  return {s.staging[index].mapped, s.staging[index].bytes};
}

std::span<const std::byte> Chain::download_bytes(ImageId image) const {
  const Impl& s = *impl_;
  const ImageDeclaration& declared = s.image(image);
  const std::string where = s.label() + ": download of '" + declared.name + "': ";
  if (!declared.is_output) throw DeviceError(where + "it is not an output");
  if (!s.has_run) throw DeviceError(where + "the chain has not run yet");
  if (!s.holds_outputs || s.device.scratch.user != &s)
    throw DeviceError(where + "since the chain ran, this or another one has been built, uploaded to, or run");
  // A history's images swap after the run.
  if (s.is_in_place()) return {s.buffer(image.index, s.last_parity).mapped, declared.bytes()};
  const HostBuffer& host = s.staging[static_cast<std::size_t>(image.index)];
  return {host.mapped, host.bytes};
}

void Chain::Impl::submit(const Segment& segment) {
  const bool is_first = segment.first_step == 0;
  if (!is_first && !segment.has_commands()) return;
  std::vector<vk::CommandBuffer> commands;
  if (is_first && needs_reset) commands.push_back(*reset_commands);
  commands.push_back(*segment.commands[static_cast<std::size_t>(parity)]);
  device.device.resetFences(*fence);
  device.queue.submit(vk::SubmitInfo({}, {}, commands), *fence);
  constexpr auto forever = std::numeric_limits<std::uint64_t>::max();
  const vk::Result result = device.device.waitForFences(*fence, true, forever);
  if (result != vk::Result::eSuccess)
    throw DeviceError(label() + ": waiting for the device: " + vk::to_string(result));
}

void Chain::Impl::run_segments() {
  for (const Segment& segment : segments) {
    submit(segment);
    if (segment.host_pass < 0) continue;
    const auto pass = static_cast<std::size_t>(segment.host_pass);
    const auto start = std::chrono::steady_clock::now();
    passes[pass].work(HostImages(*this, pass));
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    times[pass].milliseconds = elapsed.count();
  }
  for (std::size_t i = 0; i < passes.size(); ++i) {
    if (passes[i].kind != PassKind::host)
      times[i].milliseconds = timer->milliseconds(static_cast<std::uint32_t>(i));
  }
}

void Chain::run() {
  Impl& s = *impl_;
  if (!s.is_built) throw DeviceError(s.label() + ": cannot run before it is built");
  s.take_scratch();
  for (std::size_t i = 0; i < s.images.size(); ++i) {
    if (s.images[i].role == Role::input && !s.is_filled[i])
      throw DeviceError(s.label() + ": input '" + s.images[i].name + "' was not uploaded for this run");
  }
  if (s.history_is_lost && !s.needs_reset)
    throw DeviceError(s.label() + ": a run that failed has overwritten its history, which was not reset");
  s.forget_inputs();
  s.holds_outputs = false;
  s.history_is_lost = s.replaces_history;
  try {
    s.run_segments();
  } catch (const vk::DeviceLostError&) {
    throw DeviceError(s.label() + ": device '" + s.device.info.name + "' was lost while it ran");
  } catch (const vk::SystemError& error) {
    throw DeviceError(s.label() + ": running it on '" + s.device.info.name + "': " + error.what());
  }
  s.device.check_validation(s.label());
  s.needs_reset = false;
  s.history_is_lost = false;
  s.has_run = true;
  s.holds_outputs = true;
  s.last_parity = s.parity;
  if (s.has_history) s.parity = 1 - s.parity;
}

void Chain::reset_history() {
  impl_->needs_reset = true;
}

const std::vector<PassTime>& Chain::times() const {
  return impl_->times;
}

DeviceBytes Chain::device_bytes() const {
  return impl_->bytes;
}

std::uint64_t Chain::device_bytes_unaliased() const {
  return impl_->device_bytes_unaliased;
}

std::uint64_t Chain::staging_bytes() const {
  return impl_->staging_bytes;
}

}  // namespace becalm::gpu
