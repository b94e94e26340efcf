#include "core/events/hdf5/dsec_writer.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <limits>

#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr hsize_t kChunkRows = 1 << 16;
constexpr unsigned kDeflateLevel = 1;

hdf5::Handle property_list(hid_t kind) { return {H5Pcreate(kind), H5Pclose}; }

void write_attribute(hid_t object, const char* name, int value) {
  const hdf5::Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const hdf5::Handle attribute(H5Acreate2(object, name, H5T_STD_I32LE, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
  H5Awrite(attribute.get(), H5T_NATIVE_INT, &value);
}

}  // namespace

DsecWriter::DsecWriter(const std::string& path, std::string name, const RecordingHeader& header)
    : name_(std::move(name)) {
  hdf5::start_library();
  file_ = {check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)), H5Fclose};
  events_ = {check(H5Gcreate2(file_.get(), "events", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)), H5Gclose};
  if (header.width > 0) write_attribute(events_.get(), "width", header.width);
  if (header.height > 0) write_attribute(events_.get(), "height", header.height);
  t_ = make_column("events/t", H5T_STD_U32LE, H5T_NATIVE_UINT32);
  x_ = make_column("events/x", H5T_STD_U16LE, H5T_NATIVE_UINT16);
  y_ = make_column("events/y", H5T_STD_U16LE, H5T_NATIVE_UINT16);
  p_ = make_column("events/p", H5T_STD_U8LE, H5T_NATIVE_UINT8);
}

std::int64_t DsecWriter::check(std::int64_t id) const {
  if (id < 0) throw OutputError(fmt::format("{}: can't be written by the HDF5 library (disk full?)", name_));
  return id;
}

DsecWriter::Column DsecWriter::make_column(const std::string& name, std::int64_t stored_type, std::int64_t type) const {
  const hsize_t none = 0, unlimited = H5S_UNLIMITED, chunk = kChunkRows;
  const hdf5::Handle space(check(H5Screate_simple(1, &none, &unlimited)), H5Sclose);
  const hdf5::Handle creation = property_list(H5P_DATASET_CREATE);
  H5Pset_chunk(creation.get(), 1, &chunk);
  H5Pset_shuffle(creation.get());
  H5Pset_deflate(creation.get(), kDeflateLevel);
  const hid_t id =
      H5Dcreate2(file_.get(), name.c_str(), stored_type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT);
  return {hdf5::Handle(check(id), H5Dclose), type};
}

void DsecWriter::append(const Column& column, std::uint64_t first, const void* numbers, std::size_t count) const {
  const hsize_t start = first, size = count, rows = first + count;
  check(H5Dset_extent(column.id.get(), &rows));
  const hdf5::Handle in_file(check(H5Dget_space(column.id.get())), H5Sclose);
  const hdf5::Handle in_memory(check(H5Screate_simple(1, &size, nullptr)), H5Sclose);
  check(H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, &start, nullptr, &size, nullptr));
  check(H5Dwrite(column.id.get(), column.type, in_memory.get(), in_file.get(), H5P_DEFAULT, numbers));
}

void DsecWriter::write(std::span<const Event> events) {
  if (events.empty()) return;
  if (count_ == 0) offset_ = events.front().t;
  std::vector<std::uint32_t> t;
  std::vector<std::uint16_t> x, y;
  std::vector<std::uint8_t> p;
  for (const Event& event : events) {
    const std::int64_t since = event.t - offset_;
    if (since < 0 || since > std::numeric_limits<std::uint32_t>::max()) {
      throw InputError(
          fmt::format("{}: an event {} us after the first; DSEC's layout holds 0 to 2^32 - 1 (71 min): "
                      "give a time range",
                      name_, since));
    }
    while (static_cast<std::int64_t>(ms_to_idx_.size()) * 1000 <= since) ms_to_idx_.push_back(count_ + t.size());
    t.push_back(static_cast<std::uint32_t>(since));
    x.push_back(event.x);
    y.push_back(event.y);
    p.push_back(event.on ? 1 : 0);
  }
  append(t_, count_, t.data(), t.size());
  append(x_, count_, x.data(), x.size());
  append(y_, count_, y.data(), y.size());
  append(p_, count_, p.data(), p.size());
  count_ += events.size();
}

void DsecWriter::finish() {
  const Column index = make_column("ms_to_idx", H5T_STD_U64LE, H5T_NATIVE_UINT64);
  if (!ms_to_idx_.empty()) append(index, 0, ms_to_idx_.data(), ms_to_idx_.size());
  {
    const hdf5::Handle space(check(H5Screate(H5S_SCALAR)), H5Sclose);
    const hdf5::Handle offset(
        check(H5Dcreate2(file_.get(), "t_offset", H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)),
        H5Dclose);
    check(H5Dwrite(offset.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &offset_));
  }
  check(H5Fflush(file_.get(), H5F_SCOPE_LOCAL));
}

}  // namespace evbench
