#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace evbench::hdf5 {

/// Call it before any other use of the library; further calls do nothing. The library then prints no errors (they are
/// part of our messages) and, when the program ends, does not close what could not be closed before: after a full disk
/// it would crash there.
void start_library();

/// An identifier of the HDF5 library and the function that closes it.
class Handle {
 public:
  using Closer = int (*)(std::int64_t);
  Handle() = default;
  Handle(std::int64_t id, Closer close) : id_(id), close_(close) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Handle& operator=(Handle&& other) noexcept;
  std::int64_t get() const { return id_; }

 private:
  void reset();
  std::int64_t id_ = -1;
  Closer close_ = nullptr;
};

/// Numbers as in the file, in this machine's byte order.
class Values {
 public:
  enum class Type { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

  /// Calls f with a span of the numbers in their own type.
  template <class F>
  void visit(F f) const {
    switch (type) {
      case Type::u8: return f(view<std::uint8_t>());
      case Type::i8: return f(view<std::int8_t>());
      case Type::u16: return f(view<std::uint16_t>());
      case Type::i16: return f(view<std::int16_t>());
      case Type::u32: return f(view<std::uint32_t>());
      case Type::i32: return f(view<std::int32_t>());
      case Type::u64: return f(view<std::uint64_t>());
      case Type::i64: return f(view<std::int64_t>());
      case Type::f32: return f(view<float>());
      case Type::f64: return f(view<double>());
    }
  }
  std::vector<double> doubles() const;

  Type type = Type::u8;
  std::vector<std::byte> bytes;

 private:
  template <class Number>
  std::span<const Number> view() const {
    return {reinterpret_cast<const Number*>(bytes.data()), bytes.size() / sizeof(Number)};
  }
};

/// A data set of integers or floating-point numbers, read by rows: those of its first dimension. Moved, not copied.
class Dataset {
 public:
  std::uint64_t rows() const { return shape_.empty() ? 1 : shape_[0]; }
  std::uint64_t columns() const;  ///< numbers per row
  const std::vector<std::uint64_t>& shape() const { return shape_; }
  std::string describe() const;                      ///< e.g. "uint16", "float64 x 4"
  const std::string& name() const { return name_; }  ///< file and path, for messages
  bool is_floating() const { return type_ == Values::Type::f32 || type_ == Values::Type::f64; }

  /// Reads rows first ... first + count - 1. Throws InputError if the file is broken there.
  void read(std::uint64_t first, std::uint64_t count, Values& values) const;
  /// All numbers of a small data set; throws InputError when there are more than `most`.
  std::vector<double> read_all(std::uint64_t most = kMostNumbers) const;
  static constexpr std::uint64_t kMostNumbers = 1 << 26;
  double first(std::uint64_t row) const;  ///< first number of a row

 private:
  friend class File;
  std::string name_;
  Handle id_;
  std::vector<std::uint64_t> shape_;
  Values::Type type_ = Values::Type::u8;
};

/// An HDF5 file. The library's errors become InputErrors; for a missing filter (compression) the error names the Debian
/// package that has it. The library serialises its calls: readers in several threads wait for one another.
class File {
 public:
  explicit File(std::string path);

  struct Object {
    std::string path;  ///< without a leading slash
    bool is_dataset = false;
  };
  /// All objects in the file, sorted; soft and external links are not followed.
  const std::vector<Object>& objects() const { return objects_; }
  bool has_dataset(const std::string& path) const;

  Dataset dataset(const std::string& path) const;
  std::string text(const std::string& path) const;  ///< of a data set that is one string
  /// An attribute of a group ("" is the root) of up to 16 integers; empty if there is none.
  std::vector<int> attribute(const std::string& group, const std::string& name) const;
  /// A string attribute of a group or data set; empty if there is none.
  std::string text_attribute(const std::string& object, const std::string& name) const;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  Handle id_;
  std::vector<Object> objects_;
};

}  // namespace evbench::hdf5
