#include "thread_pool.hpp"

#include <pthread.h>

#include <algorithm>
#include <system_error>

namespace robotraj::native {

namespace {

constexpr std::uint64_t bits = 20;  // of the next piece, and of the number of pieces above it
constexpr std::uint64_t mask = (1u << bits) - 1;
constexpr std::size_t pieces_a_thread = 4;

/// Which process this is, counted from the one that loaded this library; fork copies no thread but its caller's.
std::atomic<unsigned> process{0};
[[maybe_unused]] const int counts_forks = pthread_atfork(nullptr, nullptr, [] { ++process; });

/// Checks a condition 1000 times; if it never holds, the caller sleeps and leaves the core to others.
template <typename Condition>
bool spin(Condition&& holds) {
  for (int i = 0; i < 1000; ++i) {
    if (holds()) return true;
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
  }
  return false;
}

}  // namespace

ThreadPool::~ThreadPool() { leave_if_elsewhere(); }

void ThreadPool::leave_if_elsewhere() {
  // The threads of the parent process do not exist here. They cannot be joined, and the destructor of their condition
  // variable would wait for ever.
  if (team_ && !team_->here()) static_cast<void>(team_.release());
}

void ThreadPool::run(std::size_t count, std::size_t step, Call call, void* context) {
  if (size_ == 1 || count <= step) {
    if (count) call(context, 0, 0, count);
    return;
  }
  leave_if_elsewhere();
  if (!team_) team_ = std::make_unique<Team>(size_);
  team_->run(count, step, call, context);
}

bool ThreadPool::Team::here() const { return process_ == process.load(std::memory_order_relaxed); }

ThreadPool::Team::Team(std::size_t size) : size_(size), process_(process.load()) {
  workers_.reserve(size_ - 1);
  try {
    while (workers_.size() + 1 < size_) workers_.emplace_back([this, thread = workers_.size() + 1] { serve(thread); });
  } catch (const std::system_error&) {
    // No further thread can be started: the existing ones do the work.
  }
}

ThreadPool::Team::~Team() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_.store(true);
  }
  wake_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::Team::run(std::size_t count, std::size_t step, Call call, void* context) {
  const std::size_t steps = (count + step - 1) / step;
  const std::size_t steps_a_piece = (steps + size_ * pieces_a_thread - 1) / (size_ * pieces_a_thread);
  const std::size_t pieces = (steps + steps_a_piece - 1) / steps_a_piece;
  count_ = count;
  piece_ = steps_a_piece * step;
  call_ = call;
  context_ = context;
  unfinished_.store(pieces, std::memory_order_relaxed);
  const std::uint64_t round = (ticket_.load(std::memory_order_relaxed) >> (2 * bits)) + 1;
  ticket_.store(round << (2 * bits) | static_cast<std::uint64_t>(pieces) << bits);
  if (asleep_.load() > 0) {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake_.notify_all();
  }
  take_pieces(0);
  while (!spin([this] { return unfinished_.load(std::memory_order_acquire) == 0; })) std::this_thread::yield();
}

void ThreadPool::Team::serve(std::size_t thread) {
  const auto wanted = [this] {
    const std::uint64_t ticket = ticket_.load();
    return (ticket & mask) < (ticket >> bits & mask) || stop_.load();
  };
  while (!stop_.load()) {
    if (!spin(wanted)) {
      std::unique_lock<std::mutex> lock(mutex_);
      ++asleep_;
      wake_.wait(lock, wanted);
      --asleep_;
    }
    take_pieces(thread);
  }
}

void ThreadPool::Team::take_pieces(std::size_t thread) {
  std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
  while ((ticket & mask) < (ticket >> bits & mask)) {
    if (!ticket_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_acq_rel)) continue;
    // This thread has a piece, so the call does not end before it and its description stays valid.
    const std::size_t begin = static_cast<std::size_t>(ticket & mask) * piece_;
    call_(context_, thread, begin, std::min(count_, begin + piece_));
    unfinished_.fetch_sub(1, std::memory_order_release);
    ticket = ticket_.load(std::memory_order_acquire);
  }
}

}  // namespace robotraj::native
