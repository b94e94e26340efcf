#include "bench/pipeline/feedback_line.hpp"

#include <utility>

namespace evbench {

void FeedbackLine::expect(double t) {
  const std::lock_guard lock(mutex_);
  expected_.push_back(t);
}

void FeedbackLine::answer(Feedback feedback) {
  const std::lock_guard lock(mutex_);
  answers_.push_back({expected_.front(), std::move(feedback)});
  expected_.pop_front();
  answered_.notify_one();
}

std::vector<Feedback> FeedbackLine::due(double now) {
  std::unique_lock lock(mutex_);
  if (!free_) answered_.wait(lock, [&] { return closed_ || expected_.empty() || !is_due(expected_.front(), now); });
  std::vector<Feedback> result;
  for (; !answers_.empty() && (free_ || is_due(answers_.front().t, now)); answers_.pop_front()) {
    result.push_back(std::move(answers_.front().feedback));
  }
  return result;
}

void FeedbackLine::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  answered_.notify_all();
}

}  // namespace evbench
