#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/additive_choice.h"
#include "app/filter_stage.h"
#include "app/fingerprints.h"
#include "app/frame_sink.h"
#include "app/input_check.h"
#include "app/input_frames.h"
#include "app/noisy_image.h"
#include "app/outputs.h"
#include "app/pipeline.h"
#include "app/profile.h"
#include "app/progress.h"
#include "app/sequence_arguments.h"
#include "frame/error.h"
#include "frame/io/exr.h"

namespace becalm::app {

/// One run of `becalm denoise` or `becalm antialias`: a sequence of EXR files through a filter into another.
class SequenceJob {
 public:
  /// `command` must live as long. Throws Error(usage) and Error(bad_input).
  SequenceJob(const SequenceCommand& command, FilterRecipe recipe);
  ExitStatus run();
  io::LoadedFrame first_frame() const;
  /// Of the outputs that are there; empty if there are none.
  std::string recorded_preset() const { return outputs_.recorded("becalm:preset"); }

 private:
  std::vector<NumberedFile> all_files() const;
  void choose_additive();
  void set_attributes();
  std::string settings() const;
  void find_existing();
  void print_plan(const std::set<int>& needed);
  std::vector<InputLayout> checked_inputs(const std::set<int>& needed);
  void tell_what_is_taken(const std::set<int>& needed, const std::set<int>& wanted);
  void tell_other_beauties(const std::string& path);
  void build_filter(const std::vector<InputLayout>& views);
  void filter_all(const std::vector<filter::Step>& steps, double work_per_step,
                  const std::function<void()>& prepare);
  io::LoadedFrame read(const filter::Step& step);
  void require_sound_input(const std::vector<int>& frames) const;
  std::string halves_text() const;
  void write(const FinishedFrame& result, FrameSink& sink);

  const SequenceCommand& command_;
  const FileMark mark_;
  const ThreadLimit threads_;
  io::LayerOptions layers_;
  FilterStage filter_;
  const io::DenoisedFormat format_;
  const InputFrames inputs_;
  Outputs outputs_;
  const std::optional<NoisyImage> noisy_image_;  ///< if it is the beauty
  const InputWindow window_;
  Fingerprints fingerprints_;
  io::Attributes attributes_;
  std::vector<AdditiveNote> additive_notes_;
  std::vector<std::string> lights_;  ///< light groups and additive layers that are denoised
  bool told_of_same_halves_ = false;
  std::set<int> existing_;
  std::optional<Progress> progress_;
  Profile profile_;
};

}  // namespace becalm::app
