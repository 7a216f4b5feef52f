#pragma once

#include <string>

#include "frame/io/exr.h"
#include "frame/stereo.h"

namespace becalm::app {

/// `--stereo-camera`: the cameras of files that do not say them.
struct GivenStereo {
  StereoCamera camera;
  bool planar = false;  ///< depths are distances along the view, not along the rays
};

/// `FOCAL_PX,SEPARATION,CONVERGENCE` and `,planar`. Throws Error(usage) for another text.
GivenStereo given_stereo(const std::string& text);

/// Tells the view's frame which eye of the cameras it is of; planar depths become distances along the rays.
void give_stereo(const GivenStereo& given, Eye eye, io::LoadedView& loaded);

}  // namespace becalm::app
