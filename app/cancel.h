#pragma once

#include <atomic>

namespace becalm::app {

/// From now on SIGINT and SIGTERM ask the command to stop and leave whole files only; a second one ends the
/// process at once with status 130. SIGPIPE is ignored: whoever reads the progress may leave before the last
/// frame.
void catch_signals();

/// True once a signal came or `request_stop` was called; what the tracer and the loops over frames look at.
const std::atomic<bool>& stop_requested();

/// Stops the command's other threads after one of them failed.
void request_stop();

/// Whether a signal was the reason.
bool interrupted();

/// For loops before anything is written: throws Error(interrupted) once a signal came.
void stop_if_asked();

}  // namespace becalm::app
