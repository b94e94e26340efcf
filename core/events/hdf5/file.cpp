#include "core/events/hdf5/file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>

#include "core/events/hdf5/filters.hpp"
#include "core/support/error.hpp"

namespace evbench::hdf5 {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

constexpr std::uint64_t kMostNumbers = std::uint64_t{1} << 48;  // of a data set
constexpr std::uint64_t kMostColumns = 1 << 20;                 // where single rows are read

/// The innermost reason of the library's last error.
std::string reason() {
  std::string text = "unknown reason";
  const auto visit = [](unsigned, const H5E_error2_t* error, void* data) -> herr_t {
    if (error->desc != nullptr && *error->desc != '\0') *static_cast<std::string*>(data) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, visit, &text);
  return text;
}

hid_t checked(hid_t id, const std::string& what) {
  if (id < 0) throw InputError(fmt::format("{}: HDF5 cannot read this: {}", what, reason()));
  return id;
}

int close_file(std::int64_t id) { return H5Fclose(id); }
int close_dataset(std::int64_t id) { return H5Dclose(id); }
int close_space(std::int64_t id) { return H5Sclose(id); }
int close_type(std::int64_t id) { return H5Tclose(id); }
int close_properties(std::int64_t id) { return H5Pclose(id); }
int close_attribute(std::int64_t id) { return H5Aclose(id); }

std::optional<Values::Type> number_type(hid_t type) {
  using Type = Values::Type;
  const H5T_class_t kind = H5Tget_class(type);
  const std::size_t size = H5Tget_size(type);
  if (kind == H5T_FLOAT) {
    if (size == 4) return Type::f32;
    if (size == 8) return Type::f64;
    return std::nullopt;
  }
  if (kind == H5T_ENUM && size == 1) return Type::i8;  // h5py's bool
  if (kind != H5T_INTEGER) return std::nullopt;
  const bool is_signed = H5Tget_sign(type) != H5T_SGN_NONE;
  switch (size) {
    case 1: return is_signed ? Type::i8 : Type::u8;
    case 2: return is_signed ? Type::i16 : Type::u16;
    case 4: return is_signed ? Type::i32 : Type::u32;
    case 8: return is_signed ? Type::i64 : Type::u64;
    default: return std::nullopt;
  }
}

struct TypeFacts {
  hid_t native;
  std::size_t size;
  const char* name;
};

TypeFacts facts(Values::Type type) {
  using Type = Values::Type;
  switch (type) {
    case Type::u8: return {H5T_NATIVE_UINT8, 1, "uint8"};
    case Type::i8: return {H5T_NATIVE_INT8, 1, "int8"};
    case Type::u16: return {H5T_NATIVE_UINT16, 2, "uint16"};
    case Type::i16: return {H5T_NATIVE_INT16, 2, "int16"};
    case Type::u32: return {H5T_NATIVE_UINT32, 4, "uint32"};
    case Type::i32: return {H5T_NATIVE_INT32, 4, "int32"};
    case Type::u64: return {H5T_NATIVE_UINT64, 8, "uint64"};
    case Type::i64: return {H5T_NATIVE_INT64, 8, "int64"};
    case Type::f32: return {H5T_NATIVE_FLOAT, 4, "float32"};
    case Type::f64: return {H5T_NATIVE_DOUBLE, 8, "float64"};
  }
  throw std::logic_error("no such type");
}

void check_filters(hid_t properties, const std::string& name) {
  for (int i = 0; i < H5Pget_nfilters(properties); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &config);
    if (filter < 0) throw InputError(fmt::format("{}: HDF5 cannot read its list of filters: {}", name, reason()));
    if (H5Zfilter_avail(filter) <= 0) {
      throw InputError(
          fmt::format("{}: is compressed with HDF5 filter {} ({}), which is not installed; plugins are "
                      "searched for in HDF5_PLUGIN_PATH",
                      name, filter, filter_hint(filter)));
    }
  }
}

/// A chunk is decompressed as a whole. Two fit in the cache, so that reading in parts decompresses a chunk once.
/// Without compression there is no cache: it would only add a copy.
void set_cache(hid_t creation, hid_t access, std::size_t number_size, const std::string& name) {
  constexpr std::uint64_t kMostCachedBytes = 256u << 20;
  if (H5Pget_layout(creation) != H5D_CHUNKED) return;
  hsize_t sides[H5S_MAX_RANK];
  const int rank = H5Pget_chunk(creation, H5S_MAX_RANK, sides);
  std::uint64_t bytes = number_size;
  for (int i = 0; i < rank; ++i) {
    if (sides[i] > kMostCachedBytes || bytes * sides[i] > kMostCachedBytes) {
      throw InputError(fmt::format("{}: has chunks above {} MiB; expected smaller ones", name, kMostCachedBytes >> 20));
    }
    bytes *= sides[i];
  }
  const bool compressed = H5Pget_nfilters(creation) > 0;
  H5Pset_chunk_cache(access, 521, compressed ? std::max<std::size_t>(1u << 20, 2 * bytes) : 0, 1.0);
}

/// Reads a string by read(to); none if it is not a single string.
template <class Read>
std::optional<std::string> read_text(hid_t type, hid_t space, const std::string& name, Read read) {
  constexpr std::size_t kMost = 4096;
  if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return std::nullopt;
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    checked(read(&text), name);
    std::string result = text == nullptr ? "" : text;
    H5free_memory(text);
    return result;
  }
  const std::size_t size = H5Tget_size(type);
  if (size > kMost) throw InputError(fmt::format("{}: has {} bytes; expected up to {}", name, size, kMost));
  std::string result(size, '\0');
  checked(read(result.data()), name);
  return result.c_str();  // up to the padding
}

/// "x, y, p, t": the numbers of a compound.
std::string member_names(hid_t type) {
  std::vector<std::string> names;
  for (int i = 0; i < H5Tget_nmembers(type); ++i) {
    char* name = H5Tget_member_name(type, static_cast<unsigned>(i));
    names.emplace_back(name == nullptr ? "" : name);
    H5free_memory(name);
  }
  return fmt::to_string(fmt::join(names, ", "));
}

/// Is the data set compressed by Metavision's filter? Only its own plugin decompresses it.
bool is_ecf(hid_t dataset) {
  constexpr H5Z_filter_t kEcf = 0x8ECF;
  const Handle creation(H5Dget_create_plist(dataset), close_properties);
  for (int i = 0; i < H5Pget_nfilters(creation.get()); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    if (H5Pget_filter2(creation.get(), static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &config) ==
        kEcf) {
      return true;
    }
  }
  return false;
}

[[noreturn]] void refuse_type(hid_t dataset, hid_t type, const std::string& name) {
  if (H5Tget_class(type) != H5T_COMPOUND) {
    throw InputError(fmt::format("{}: has no numbers; expected integers or floating point", name));
  }
  throw InputError(
      fmt::format("{}: is a compound type ({:.80}), as Metavision writes it{}; expected data sets of numbers, or what "
                  "metavision_file_to_csv or metavision_file_to_dat makes of such a file",
                  name, member_names(type), is_ecf(dataset) ? ", compressed with its ECF filter" : ""));
}

#if H5_VERSION_GE(1, 12, 0)
using ObjectInfo = H5O_info2_t;
constexpr auto kVisitObjects = H5Ovisit3;
#else
using ObjectInfo = H5O_info_t;
constexpr auto kVisitObjects = H5Ovisit2;
#endif

herr_t add_object(hid_t, const char* name, const ObjectInfo* info, void* data) {
  constexpr std::size_t kMost = 10'000;
  auto& objects = *static_cast<std::vector<File::Object>*>(data);
  if (std::strcmp(name, ".") == 0) return 0;
  objects.push_back({name, info->type == H5O_TYPE_DATASET});
  return objects.size() < kMost ? 0 : 1;
}

}  // namespace

void start_library() {
  static const bool left_alone = H5dont_atexit() >= 0;  // fails if another part of the program was first: no harm
  static_cast<void>(left_alone);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = other.id_;
    close_ = other.close_;
    other.id_ = -1;
  }
  return *this;
}

void Handle::reset() {
  if (id_ >= 0 && close_ != nullptr) close_(id_);
  id_ = -1;
}

std::vector<double> Values::doubles() const {
  std::vector<double> result;
  visit([&](auto numbers) {
    result.reserve(numbers.size());
    for (const auto number : numbers) result.push_back(static_cast<double>(number));
  });
  return result;
}

std::uint64_t Dataset::columns() const {
  std::uint64_t product = 1;
  for (std::size_t i = 1; i < shape_.size(); ++i) product *= shape_[i];
  return product;
}

std::string Dataset::describe() const {
  std::string text = facts(type_).name;
  for (std::size_t i = 1; i < shape_.size(); ++i) text += fmt::format(" x {}", shape_[i]);
  return text;
}

void Dataset::read(std::uint64_t first, std::uint64_t count, Values& values) const {
  const TypeFacts type = facts(type_);
  values.type = type_;
  values.bytes.resize(count * columns() * type.size);
  if (values.bytes.empty()) return;
  std::vector<hsize_t> from(shape_.size(), 0), extent(shape_.begin(), shape_.end());
  const Handle space(checked(H5Dget_space(id_.get()), name_), close_space);
  if (!shape_.empty()) {
    from[0] = first;
    extent[0] = count;
    checked(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, from.data(), nullptr, extent.data(), nullptr), name_);
  }
  const Handle memory(checked(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), name_),
                      close_space);
  if (H5Dread(id_.get(), type.native, memory.get(), space.get(), H5P_DEFAULT, values.bytes.data()) < 0) {
    throw InputError(fmt::format("{}: rows {} to {} are broken: {}", name_, first, first + count - 1, reason()));
  }
}

std::vector<double> Dataset::read_all(std::uint64_t most) const {
  if (columns() > most || rows() > most / std::max<std::uint64_t>(columns(), 1)) {
    throw InputError(
        fmt::format("{}: has {} rows of {} numbers; expected up to {} numbers in all", name_, rows(), columns(), most));
  }
  Values values;
  read(0, rows(), values);
  return values.doubles();
}

double Dataset::first(std::uint64_t row) const {
  if (columns() == 0 || columns() > kMostColumns) {
    throw InputError(fmt::format("{}: has rows of {} numbers; expected 1 to {}", name_, columns(), kMostColumns));
  }
  Values values;
  read(row, 1, values);
  return values.doubles().at(0);
}

File::File(std::string path) : path_(std::move(path)) {
  start_library();
  register_filters();
  id_ = Handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), close_file);
  checked(id_.get(), path_);
  checked(kVisitObjects(id_.get(), H5_INDEX_NAME, H5_ITER_INC, add_object, &objects_, H5O_INFO_BASIC), path_);
  std::sort(objects_.begin(), objects_.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
}

bool File::has_dataset(const std::string& path) const {
  return std::any_of(objects_.begin(), objects_.end(),
                     [&](const Object& object) { return object.is_dataset && object.path == path; });
}

Dataset File::dataset(const std::string& path) const {
  Dataset dataset;
  dataset.name_ = fmt::format("{}: /{}", path_, path);
  const std::string& name = dataset.name_;
  Handle id(checked(H5Dopen2(id_.get(), path.c_str(), H5P_DEFAULT), name), close_dataset);
  const Handle type(checked(H5Dget_type(id.get()), name), close_type);
  const auto number = number_type(type.get());
  if (!number) refuse_type(id.get(), type.get(), name);
  dataset.type_ = *number;
  const Handle space(checked(H5Dget_space(id.get()), name), close_space);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 0) throw InputError(fmt::format("{}: has no shape: {}", name, reason()));
  std::vector<hsize_t> shape(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  std::uint64_t numbers_left = kMostNumbers;
  for (const hsize_t side : shape) {
    if (side > numbers_left) throw InputError(fmt::format("{}: has a shape too large to be true", name));
    numbers_left /= std::max<hsize_t>(side, 1);
  }
  dataset.shape_.assign(shape.begin(), shape.end());

  const Handle creation(checked(H5Dget_create_plist(id.get()), name), close_properties);
  check_filters(creation.get(), name);
  const Handle access(checked(H5Pcreate(H5P_DATASET_ACCESS), name), close_properties);
  set_cache(creation.get(), access.get(), facts(*number).size, name);
  id = Handle();  // the cache's size only counts for the first that opens it
  dataset.id_ = Handle(checked(H5Dopen2(id_.get(), path.c_str(), access.get()), name), close_dataset);
  return dataset;
}

std::string File::text(const std::string& path) const {
  const std::string name = fmt::format("{}: /{}", path_, path);
  const Handle id(checked(H5Dopen2(id_.get(), path.c_str(), H5P_DEFAULT), name), close_dataset);
  const Handle type(checked(H5Dget_type(id.get()), name), close_type);
  const Handle space(checked(H5Dget_space(id.get()), name), close_space);
  const auto text = read_text(type.get(), space.get(), name, [&](void* to) {
    return H5Dread(id.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, to);
  });
  if (!text) throw InputError(fmt::format("{}: is not a string; expected one", name));
  return *text;
}

std::string File::text_attribute(const std::string& object, const std::string& name) const {
  const std::string of = "/" + object, place = fmt::format("{}: {}: attribute {}", path_, of, name);
  if (H5Aexists_by_name(id_.get(), of.c_str(), name.c_str(), H5P_DEFAULT) <= 0) return "";
  const Handle id(H5Aopen_by_name(id_.get(), of.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), close_attribute);
  checked(id.get(), place);
  const Handle type(checked(H5Aget_type(id.get()), place), close_type);
  const Handle space(checked(H5Aget_space(id.get()), place), close_space);
  return read_text(type.get(), space.get(), place, [&](void* to) { return H5Aread(id.get(), type.get(), to); })
      .value_or("");
}

std::vector<int> File::attribute(const std::string& group, const std::string& name) const {
  constexpr hssize_t kMost = 16;
  const std::string object = "/" + group;
  if (H5Aexists_by_name(id_.get(), object.c_str(), name.c_str(), H5P_DEFAULT) <= 0) return {};
  const Handle id(H5Aopen_by_name(id_.get(), object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), close_attribute);
  checked(id.get(), path_);
  const Handle type(checked(H5Aget_type(id.get()), path_), close_type);
  const Handle space(checked(H5Aget_space(id.get()), path_), close_space);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (H5Tget_class(type.get()) != H5T_INTEGER || count < 1 || count > kMost) return {};
  std::vector<int> values(static_cast<std::size_t>(count));
  checked(H5Aread(id.get(), H5T_NATIVE_INT, values.data()), path_);
  return values;
}

}  // namespace evbench::hdf5
