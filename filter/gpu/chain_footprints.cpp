// How far passes read: the rules of tiles, and single passes for the tests of their footprints.

#include <algorithm>

#include "filter/gpu/chain_impl.h"

namespace becalm::gpu {

Chain::Chain(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

std::vector<DeclaredPass> Chain::declared_passes() const {
  // What a fill writes is the same in all tiles, too.
  std::vector<bool> is_table;
  for (const ImageDeclaration& image : impl_->images) is_table.push_back(image.is_table);
  for (const PassDeclaration& pass : impl_->passes) {
    for (const Use& use : pass.uses) {
      if (use.writes()) is_table[static_cast<std::size_t>(use.image)] = pass.kind == PassKind::fill;
    }
  }
  std::vector<DeclaredPass> declared;
  for (const PassDeclaration& pass : impl_->passes) {
    DeclaredPass& to = declared.emplace_back();
    to.name = pass.name;
    for (const Use& use : pass.uses) {
      const bool table = is_table[static_cast<std::size_t>(use.image)];
      if (use.reads()) to.reads.push_back({{use.image}, table ? anywhere() : use.footprint});
      if (use.writes()) to.writes.push_back({use.image});
    }
  }
  return declared;
}

TileRules Chain::tile_rules() const {
  std::vector<PassFootprints> passes;
  for (const DeclaredPass& declared : declared_passes()) {
    PassFootprints& pass = passes.emplace_back();
    for (const auto& [image, footprint] : declared.reads) pass.reads.push_back({image.index, footprint});
    for (const ImageId image : declared.writes) pass.writes.push_back(image.index);
  }
  std::vector<OutputScale> outputs;
  for (std::size_t i = 0; i < impl_->images.size(); ++i) {
    const ImageDeclaration& image = impl_->images[i];
    if (image.is_output) outputs.push_back({static_cast<int>(i), image.pixel_px});
  }
  try {
    return gpu::tile_rules(passes, outputs);
  } catch (const FootprintError& error) {
    throw DeviceError(impl_->label() + ": image '" + impl_->image({error.image}).name + "' " + error.what());
  }
}

Extent Chain::extent(ImageId image) const {
  return impl_->image(image).extent;
}

Format Chain::format(ImageId image) const {
  return impl_->image(image).format;
}

Chain Chain::single_pass(std::size_t pass) const {
  impl_->require_declaring();
  const PassDeclaration& declared = impl_->passes[pass];
  Chain chain(std::make_unique<Impl>(impl_->device, impl_->label(pass), impl_->options));
  Impl& single = *chain.impl_;
  for (const ImageDeclaration& image : impl_->images) {
    single.images.push_back({image.name, image.format, image.extent, Role::transient});
  }
  for (const Use& use : declared.uses) {
    if (!use.writes()) single.images[static_cast<std::size_t>(use.image)].role = Role::input;
    if (!use.writes() || declared.kind == PassKind::fill) continue;
    chain.fill({use.image}, 0.0f);
    chain.output({use.image});
  }
  single.passes.push_back(declared);
  single.has_host_passes = declared.kind == PassKind::host;
  return chain;
}

}  // namespace becalm::gpu
