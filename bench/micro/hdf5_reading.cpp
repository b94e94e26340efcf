// Speed of reading HDF5 files of events, compared with the HDF5 library; one thread, warm page cache:
//
//   hdf5_reading [MILLIONS]     writes files of that many million random events (10) to a temporary folder, and reads
//                               each three times; the best counts
//
// "library" only reads the columns x, y, t, p with H5Dread into memory, in the types that the file has: some rows at a
// time, which stay in the processor's caches, or all at once. "reader" makes events of them, "stream" also checks
// them, as for all users. Million events a second of processor time, and shares of the library's.

#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>
#include <zstd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "bench/micro/reading_speed.hpp"
#include "core/events/event_stream.hpp"
#include "core/events/formats.hpp"
#include "core/events/hdf5/file.hpp"
#include "core/events/hdf5/filters.hpp"

namespace {

using namespace evbench;
using hdf5::Handle;

hid_t checked(hid_t id, const char* what) {
  if (id < 0) throw std::runtime_error(fmt::format("the HDF5 library can't do this: {}", what));
  return id;
}

constexpr hsize_t kChunk = 1 << 16;
constexpr H5Z_filter_t kBlosc = 32001, kLz4 = 32004, kZstd = 32015;

struct Storage {
  const char* name;
  bool chunked = true;
  H5Z_filter_t filter = 0;  ///< 0: none
};

const Storage kStorages[] = {
    {"contiguous", false},          {"chunks"},          {"deflate 1, shuffled", true, H5Z_FILTER_DEFLATE},
    {"blosc (zstd)", true, kBlosc}, {"lz4", true, kLz4}, {"zstd", true, kZstd},
};

Handle make_layout(const Storage& storage) {
  Handle creation(checked(H5Pcreate(H5P_DATASET_CREATE), "creation list"), H5Pclose);
  const unsigned level = 1, blosc[] = {0, 0, 0, 0, level, 1, 5};
  if (storage.chunked) H5Pset_chunk(creation.get(), 1, &kChunk);
  if (storage.filter == H5Z_FILTER_DEFLATE) H5Pset_shuffle(creation.get());
  if (storage.filter != 0) {
    const bool is_blosc = storage.filter == kBlosc, is_deflate = storage.filter == H5Z_FILTER_DEFLATE;
    checked(H5Pset_filter(creation.get(), storage.filter, H5Z_FLAG_OPTIONAL,
                          is_blosc     ? 7
                          : is_deflate ? 1
                                       : 0,
                          is_blosc ? blosc : &level),
            "filter");
  }
  return creation;
}

/// A column of whole chunks.
template <class Number>
void write_column(hid_t file, const char* name, hid_t type, const std::vector<Number>& numbers,
                  const Storage& storage) {
  const hsize_t rows = numbers.size();
  const Handle space(checked(H5Screate_simple(1, &rows, nullptr), name), H5Sclose);
  const Handle creation = make_layout(storage);
  const Handle column(
      checked(H5Dcreate2(file, name, type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT), name), H5Dclose);
  if (storage.filter != kZstd) {
    checked(H5Dwrite(column.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()), name);
    return;
  }
  constexpr std::size_t kBytes = kChunk * sizeof(Number);  // this filter only reads: its chunks are written as they are
  std::vector<char> packed(ZSTD_compressBound(kBytes));
  for (hsize_t row = 0; row < rows; row += kChunk) {
    const std::size_t size = ZSTD_compress(packed.data(), packed.size(), &numbers[row], kBytes, 1);
    checked(H5Dwrite_chunk(column.get(), H5P_DEFAULT, 0, &row, size, packed.data()), name);
  }
}

/// In types as DSEC has them.
void write_file(const std::string& path, const Storage& storage, std::size_t count) {
  std::vector<std::uint16_t> x, y;
  std::vector<std::uint32_t> t;
  std::vector<std::uint8_t> p;
  std::uint64_t state = 1;
  for (std::size_t i = 0; i < count; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t bits = state >> 33;
    x.push_back(static_cast<std::uint16_t>(bits % 640));
    y.push_back(static_cast<std::uint16_t>((bits >> 8) % 480));
    t.push_back(static_cast<std::uint32_t>(i / 4));
    p.push_back(bits >> 20 & 1);
  }
  const Handle file(checked(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), path.c_str()), H5Fclose);
  write_column(file.get(), "x", H5T_NATIVE_UINT16, x, storage);
  write_column(file.get(), "y", H5T_NATIVE_UINT16, y, storage);
  write_column(file.get(), "t", H5T_NATIVE_UINT32, t, storage);
  write_column(file.get(), "p", H5T_NATIVE_UINT8, p, storage);
}

/// The library alone.
class Columns {
 public:
  Columns(const std::string& path, std::size_t rows_at_a_time)
      : file_(checked(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), path.c_str()), H5Fclose),
        most_(rows_at_a_time) {
    constexpr std::array<const char*, 4> kNames{"x", "y", "t", "p"};
    for (std::size_t i = 0; i < 4; ++i) {
      columns_[i].id = Handle(checked(H5Dopen2(file_.get(), kNames[i], H5P_DEFAULT), kNames[i]), H5Dclose);
      columns_[i].space = Handle(checked(H5Dget_space(columns_[i].id.get()), kNames[i]), H5Sclose);
      columns_[i].type = Handle(checked(H5Dget_type(columns_[i].id.get()), kNames[i]), H5Tclose);
      columns_[i].numbers.resize(most_ * H5Tget_size(columns_[i].type.get()));
    }
    length_ = static_cast<std::size_t>(H5Sget_simple_extent_npoints(columns_[0].space.get()));
  }

  /// Leaves the events as they are: only their number counts here.
  bool read(std::vector<Event>& events) {
    const hsize_t first = next_, count = std::min(most_, length_ - next_);
    events.resize(count);
    if (count == 0) return false;
    const Handle memory(checked(H5Screate_simple(1, &count, nullptr), "rows"), H5Sclose);
    for (Column& column : columns_) {
      checked(H5Sselect_hyperslab(column.space.get(), H5S_SELECT_SET, &first, nullptr, &count, nullptr), "rows");
      checked(H5Dread(column.id.get(), column.type.get(), memory.get(), column.space.get(), H5P_DEFAULT,
                      column.numbers.data()),
              "rows");
    }
    next_ += count;
    return true;
  }

 private:
  struct Column {
    Handle id, space, type;
    std::vector<char> numbers;
  };
  Handle file_;
  std::array<Column, 4> columns_;
  std::size_t most_, length_ = 0, next_ = 0;
};

double speed(const Reading& reading) { return 1e-6 * static_cast<double>(reading.events) / reading.processor_s; }

void measure(const Storage& storage, std::size_t count, const std::string& path) {
  if (storage.filter != 0 && H5Zfilter_avail(storage.filter) <= 0) {
    fmt::print("{:<20} {}\n", storage.name, hdf5::filter_hint(storage.filter));
    return;
  }
  write_file(path, storage, count);
  const double reader = speed(measure_reading([&] { return open_events(path); }));
  const double stream = speed(measure_reading([&] { return std::make_unique<EventStream>(path); }));
  fmt::print("{:<20} {:>8.2f}\n", storage.name,
             static_cast<double>(std::filesystem::file_size(path)) / static_cast<double>(count));
  for (const std::size_t rows : {std::size_t{1} << 16, std::size_t{1} << 20, count}) {
    const double library = speed(measure_reading([&] { return std::make_unique<Columns>(path, rows); }));
    fmt::print("{:<29} {:>10.1f} {:>10} {:>10.1f} {:>5.0f} % {:>10.1f} {:>5.0f} %\n", "", library, rows, reader,
               100.0 * reader / library, stream, 100.0 * stream / library);
  }
  std::filesystem::remove(path);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    hdf5::register_filters();
    // Whole chunks.
    const std::size_t millions = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10;
    const std::size_t count = std::max<std::size_t>(millions * 1'000'000 / kChunk, 1) * kChunk;
    const std::string path =
        fmt::format("{}/hdf5_reading-{}.h5", std::filesystem::temp_directory_path().string(), ::getpid());
    fmt::print("{:<20} {:>8} {:>10} {:>10} {:>10} {:>7} {:>10} {:>7}\n", "storage", "bytes", "library", "rows",
               "reader", "", "stream", "");
    for (const Storage& storage : kStorages) measure(storage, count, path);
    fmt::print("bytes: of an event; rows: that the library reads at a time\n");
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "hdf5_reading: {}\n", error.what());
    return 2;
  }
}
