#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/events/bytes/bytes.hpp"

namespace evbench {

/// A table of a FlatBuffer (https://flatbuffers.dev/internals/). The bytes are not trusted: what lies outside of them
/// counts as absent.
class FlatTable {
 public:
  /// The root of a size-prefixed buffer with this identifier.
  static std::optional<FlatTable> root(std::span<const std::byte> bytes, std::string_view identifier) {
    constexpr std::size_t kPrefix = 4;
    if (bytes.size() < kPrefix + 8 || load<std::uint32_t>(bytes.data()) > bytes.size() - kPrefix) return std::nullopt;
    bytes = bytes.subspan(kPrefix, load<std::uint32_t>(bytes.data()));
    if (bytes.size() < 8 || std::string_view(reinterpret_cast<const char*>(bytes.data()) + 4, 4) != identifier) {
      return std::nullopt;
    }
    return at(bytes, load<std::uint32_t>(bytes.data()));
  }

  template <class T>
  T get(std::size_t field, T otherwise = {}) const {
    const std::size_t place = find(field);
    return place == 0 || place + sizeof(T) > bytes_.size() ? otherwise : load<T>(bytes_.data() + place);
  }

  /// The elements of a vector of structs, or the characters of a string. Empty if the field is absent, none if it is
  /// cut.
  std::optional<std::span<const std::byte>> elements(std::size_t field, std::size_t size) const {
    const std::size_t offset = find(field), place = follow(offset);
    if (offset == 0) return std::span<const std::byte>();
    if (place == 0 || place + 4 > bytes_.size()) return std::nullopt;
    const std::uint64_t length = std::uint64_t{load<std::uint32_t>(bytes_.data() + place)} * size;
    if (length > bytes_.size() - place - 4) return std::nullopt;
    return bytes_.subspan(place + 4, static_cast<std::size_t>(length));
  }
  std::string_view text(std::size_t field) const {
    const auto characters = elements(field, 1).value_or(std::span<const std::byte>());
    return {reinterpret_cast<const char*>(characters.data()), characters.size()};
  }

  /// A table of a vector of tables. `element`: one of the elements of `elements(field, 4)`.
  std::optional<FlatTable> table(std::span<const std::byte> element) const {
    const std::size_t place = follow(static_cast<std::size_t>(element.data() - bytes_.data()));
    return place == 0 ? std::nullopt : at(bytes_, place);
  }

 private:
  static std::optional<FlatTable> at(std::span<const std::byte> bytes, std::size_t place) {
    if (place > bytes.size() || bytes.size() - place < 4) return std::nullopt;
    const std::int64_t fields = static_cast<std::int64_t>(place) - load<std::int32_t>(bytes.data() + place);
    if (fields < 0 || fields + 4 > static_cast<std::int64_t>(bytes.size())) return std::nullopt;
    FlatTable table;
    table.bytes_ = bytes;
    table.place_ = place;
    table.fields_ = static_cast<std::size_t>(fields);
    table.count_ = load<std::uint16_t>(bytes.data() + table.fields_) / 2u;
    return table;
  }

  /// Position of a field; 0: absent.
  std::size_t find(std::size_t field) const {
    const std::size_t entry = fields_ + 2 * (field + 2);
    if (field + 2 >= count_ || entry + 2 > bytes_.size()) return 0;
    const std::size_t offset = load<std::uint16_t>(bytes_.data() + entry);
    return offset == 0 || place_ + offset > bytes_.size() ? 0 : place_ + offset;
  }

  /// Target of the offset at this position; 0: none.
  std::size_t follow(std::size_t place) const {
    if (place == 0 || place + 4 > bytes_.size()) return 0;
    const std::size_t target = place + load<std::uint32_t>(bytes_.data() + place);
    return target > bytes_.size() ? 0 : target;
  }

  std::span<const std::byte> bytes_;
  std::size_t place_ = 0, fields_ = 0, count_ = 0;
};

}  // namespace evbench
