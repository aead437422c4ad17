// Threads that are made once and share the points of a block, piece by piece.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace robotraj::native {

/// A fixed team of threads, the caller being thread 0.
///
/// The pieces of the work do not depend on the thread that computes them, so results do not either. The caller computes
/// pieces too: where the machine is busy and no other thread wakes, it does all the work and waits for none of them.
/// Between calls the other threads spin for some microseconds before they sleep. One caller at a time. A forked process
/// has none of these threads and starts its own.
class ThreadPool {
 public:
  /// A pool of `threads` in all, the others made when there is something to share for the first time.
  explicit ThreadPool(std::size_t threads) : size_(threads > 0 ? threads : 1) {}
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  std::size_t size() const { return size_; }

  /// Calls work(thread, begin, end) for pieces that cover [0, count) once, each beginning at a multiple of `step`.
  ///
  /// A thread may get several pieces, or none. The work must not throw.
  template <typename Work>
  void split(std::size_t count, std::size_t step, Work&& work) {
    using Plain = std::remove_reference_t<Work>;
    auto call = [](void* context, std::size_t thread, std::size_t begin, std::size_t end) {
      (*static_cast<Plain*>(context))(thread, begin, end);
    };
    run(count, step, call, const_cast<void*>(static_cast<const void*>(std::addressof(work))));
  }

 private:
  using Call = void (*)(void* context, std::size_t thread, std::size_t begin, std::size_t end);

  /// The other threads, and the state they share with the caller.
  class Team {
   public:
    explicit Team(std::size_t size);
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    void run(std::size_t count, std::size_t step, Call call, void* context);
    /// Whether its threads are in this process.
    bool here() const;

   private:
    void serve(std::size_t thread);
    void take_pieces(std::size_t thread);

    const std::size_t size_;
    const unsigned process_;
    std::vector<std::thread> workers_;
    std::mutex mutex_;
    std::condition_variable wake_;
    // The number of the call, of its pieces and of the next piece, in one word. So a late thread takes no piece of a
    // call that is over, nor one of the next call by mistake.
    std::atomic<std::uint64_t> ticket_{0};
    std::atomic<std::size_t> unfinished_{0};
    std::atomic<int> asleep_{0};
    std::atomic<bool> stop_{false};
    std::size_t count_ = 0;
    std::size_t piece_ = 1;
    Call call_ = nullptr;
    void* context_ = nullptr;
  };

  void run(std::size_t count, std::size_t step, Call call, void* context);
  void leave_if_elsewhere();

  const std::size_t size_;
  std::unique_ptr<Team> team_;
};

}  // namespace robotraj::native
