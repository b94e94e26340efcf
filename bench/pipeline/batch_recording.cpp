#include "bench/pipeline/batch_recording.hpp"

#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "core/io/file_content.hpp"
#include "core/io/sha256.hpp"
#include "core/plugin/options.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

constexpr std::string_view kBegin = "evbench batches 3\n";
constexpr std::size_t kDigestLength = 64;

template <class Value>
void append_number(std::string& bytes, const Value& value) {
  static_assert(std::is_arithmetic_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_batch(std::string& bytes, const TrackBatch& batch) {
  append_number(bytes, batch.until);
  append_number(bytes, batch.known_at());
  append_number(bytes, std::uint64_t{batch.observations.size()});
  for (const TrackObservation& z : batch.observations) {
    append_number(bytes, z.track);
    append_number(bytes, z.t);
    append_number(bytes, z.pixel.x());
    append_number(bytes, z.pixel.y());
    for (const double value : {z.noise.xx(), z.noise.xy(), z.noise.yy()}) append_number(bytes, value);
  }
  append_number(bytes, std::uint64_t{batch.ended.size()});
  for (const TrackEnd& end : batch.ended) {
    append_number(bytes, end.track);
    append_number(bytes, end.t);
  }
}

/// The bytes after the batches are the facts as JSON, their length and the digest.
std::string format_facts(const FrontFacts& facts) {
  Json work = Json::array();
  for (const Work& of_batch : facts.work) work.push_back({of_batch.until, of_batch.seconds});
  const Json json = {{"source_s", facts.source_s},
                     {"frontend_s", facts.frontend_s},
                     {"work", work},
                     {"data_s", facts.data_s},
                     {"log", facts.log}};
  return printable_json(json);
}

}  // namespace

std::string record_batches(BatchStream& batches) {
  std::string bytes(kBegin);
  while (const std::optional<TrackBatch> batch = batches.next()) append_batch(bytes, *batch);
  const std::string facts = format_facts(batches.facts());
  bytes += facts;
  append_number(bytes, std::uint64_t{facts.size()});
  return bytes + sha256(bytes);
}

std::unique_ptr<RecordedBatches> RecordedBatches::open(const std::string& path) {
  std::string bytes = file_content(path).value_or("");
  if (bytes.size() < kBegin.size() + sizeof(std::uint64_t) + kDigestLength || !bytes.starts_with(kBegin))
    return nullptr;
  const std::string digest = bytes.substr(bytes.size() - kDigestLength);
  bytes.resize(bytes.size() - kDigestLength);
  if (sha256(bytes) != digest) return nullptr;
  return std::unique_ptr<RecordedBatches>(new RecordedBatches(std::move(bytes)));
}

RecordedBatches::RecordedBatches(std::string bytes) : bytes_(std::move(bytes)) {
  at_ = bytes_.size() - sizeof(std::uint64_t);
  const auto length = static_cast<std::size_t>(take<std::uint64_t>());
  end_ = bytes_.size() - sizeof(std::uint64_t) - length;
  at_ = kBegin.size();
  const Json json = parse_json(bytes_.substr(end_, length));
  std::vector<Work> work;
  for (const Json& of_batch : json.at("work")) work.push_back({of_batch[0].get<double>(), of_batch[1].get<double>()});
  facts_ = {json.at("source_s").get<double>(), json.at("frontend_s").get<double>(), std::move(work),
            json.at("data_s").get<double>(), json.at("log").get<std::vector<std::string>>()};
}

template <class Value>
Value RecordedBatches::take() {
  Value value;
  std::memcpy(&value, bytes_.data() + at_, sizeof value);
  at_ += sizeof value;
  return value;
}

TrackBatch RecordedBatches::take_batch() {
  TrackBatch batch;
  batch.until = take<double>();
  batch.seen = take<double>();
  batch.observations.resize(take<std::uint64_t>());
  for (TrackObservation& z : batch.observations) {
    z.track = take<TrackId>();
    z.t = take<double>();
    z.pixel.x() = take<double>();
    z.pixel.y() = take<double>();
    const double xx = take<double>(), xy = take<double>();
    z.noise = {xx, xy, take<double>()};
  }
  batch.ended.resize(take<std::uint64_t>());
  for (TrackEnd& end : batch.ended) {
    end.track = take<TrackId>();
    end.t = take<double>();
  }
  return batch;
}

std::optional<TrackBatch> RecordedBatches::next() {
  if (at_ == end_) return std::nullopt;
  return watch_.time([&] { return take_batch(); });
}

}  // namespace evbench
