#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace becalm::app {

/// One step of the way from input to file on a thread of its own: works on items in the order they are
/// pushed, while the pusher makes the next one. At most `capacity` items wait, so that memory stays bounded.
template <class Item>
class Stage {
 public:
  /// `on_failure` is called on the stage's thread when `work` throws; what waits is dropped then.
  Stage(std::size_t capacity, std::function<void(Item&)> work, std::function<void()> on_failure)
      : capacity_(capacity),
        work_(std::move(work)),
        on_failure_(std::move(on_failure)),
        thread_([this] { run(); }) {}

  /// Works off what waits, as when the pusher failed: what is done already is not lost.
  ~Stage() { close(/*drop=*/false); }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Waits for room. After a failure the item is dropped; `finish` tells.
  void push(Item item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_.size() < capacity_ || failure_; });
    if (failure_) return;
    waiting_.push_back(std::move(item));
    changed_.notify_all();
  }

  /// Waits for the item at work and, unless `drop`, for those waiting. Throws what `work` threw.
  void finish(bool drop = false) {
    close(drop);
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void close(bool drop) {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      if (drop) waiting_.clear();
      changed_.notify_all();
    }
    if (thread_.joinable()) thread_.join();
  }

  void run() {
    while (true) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      Item item = std::move(waiting_.front());
      waiting_.pop_front();
      changed_.notify_all();
      lock.unlock();
      try {
        work_(item);
      } catch (...) {
        lock.lock();
        failure_ = std::current_exception();
        waiting_.clear();
        changed_.notify_all();
        lock.unlock();
        on_failure_();
        return;
      }
    }
  }

  const std::size_t capacity_;
  const std::function<void(Item&)> work_;
  const std::function<void()> on_failure_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> waiting_;
  bool closed_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace becalm::app
