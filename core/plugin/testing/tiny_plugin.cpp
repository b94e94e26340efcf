// Back-ends in a shared library for library.test.cpp; they estimate nothing.
#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"

namespace {

class Tiny : public evbench::BackEnd {
 public:
  struct Options {
    int count = 3;
    void declare(evbench::OptionSet& set) { set.add("count", count, "a number").range(0); }
  };

  Tiny(const Options& options, const evbench::BackEndContext& context) {
    if (options.count == 0) throw evbench::InputError(context.place + ".count: is 0; expected at least 1");
    status_.reason = std::to_string(options.count);
  }

  void advance(const evbench::UndistortedBatch&) override {}
  evbench::BackEndFeedback feedback(const evbench::FeedbackNeeds&) override { return {}; }
  void finish() override {}
  evbench::Status status() const override { return status_; }
  evbench::PoseTrajectory trajectory() const override { return {}; }
  std::vector<evbench::Landmark> map() const override { return {}; }

 private:
  evbench::Status status_;
};

#ifdef TWIN
const evbench::Registration<evbench::BackEnd, Tiny> first("another", "comes before the name that is taken");
#endif
const evbench::Registration<evbench::BackEnd, Tiny> registration("tiny", "estimates nothing");

}  // namespace
