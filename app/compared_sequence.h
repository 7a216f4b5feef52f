#pragma once

#include <Imath/ImathVec.h>

#include <string>
#include <vector>

#include "frame/image.h"
#include "frame/io/layers.h"
#include "frame/io/sequence.h"

namespace becalm::app {

/// A file's beauty, with the view that it is of and where its first pixel lies.
struct PlacedBeauty {
  std::string path;
  std::string view;  ///< empty if the file does not name it
  Image beauty;
  Imath::V2i first;
  Imath::V2d display_middle;
};

/// The files of a reference or of what is measured against it.
class ComparedSequence {
 public:
  /// `layers`: as --layers gives them; `view`: as --view does.
  ComparedSequence(const std::string& pattern, io::LayerOptions layers, std::string view);

  const io::SequencePattern& pattern() const { return pattern_; }
  /// Where Blender has denoised the frames, measures what it rendered, as `denoise` takes it.
  void choose_layer(const std::vector<int>& frames);
  /// The view asked for, or the file's first one. Throws Error(bad_input) if there is no such view.
  PlacedBeauty read(int frame);
  /// The view asked for, or that of the reference's name or eye, or the first if the reference is of no eye.
  /// Throws Error(bad_input) if there is no such view, or if it is of another size or place.
  Image read_like(int frame, const PlacedBeauty& reference);

 private:
  PlacedBeauty read_view(int frame, const std::string& of_reference);

  const io::SequencePattern pattern_;
  io::LayerOptions layers_;
  const std::string view_;
  bool told_views_ = false;  ///< that other views are not measured
};

}  // namespace becalm::app
