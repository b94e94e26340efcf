#pragma once

#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/testing/catch2.hpp"

namespace evbench::testing {

/// Writes files with the HDF5 library itself.
class Hdf5Writer {
 public:
  explicit Hdf5Writer(const std::string& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {
    REQUIRE(file_ >= 0);
    groups_ = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(groups_, 1);
  }
  ~Hdf5Writer() {
    H5Pclose(groups_);
    H5Fclose(file_);
  }
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  /// A filter implies chunks; a negative one means chunks without a filter.
  template <class Number>
  void add(const std::string& path, const std::vector<Number>& numbers, hsize_t columns = 0, H5Z_filter_t filter = 0) {
    const hsize_t rows = numbers.size() / std::max<hsize_t>(columns, 1);
    const hsize_t shape[] = {rows, columns}, chunk[] = {std::min<hsize_t>(rows, 1000), columns};
    const int rank = columns == 0 ? 1 : 2;
    const hid_t space = H5Screate_simple(rank, shape, nullptr), creation = H5Pcreate(H5P_DATASET_CREATE);
    if (filter != 0) {
      H5Pset_chunk(creation, rank, chunk);
    }
    if (filter > 0) {
      const unsigned blosc_zstd[] = {0, 0, 0, 0, 5, 1, 5};
      H5Pset_filter(creation, filter, H5Z_FLAG_OPTIONAL, filter == 32001 ? 7 : 0, blosc_zstd);
    }
    const hid_t set = H5Dcreate2(file_, path.c_str(), type(Number()), space, groups_, creation, H5P_DEFAULT);
    REQUIRE(set >= 0);
    REQUIRE(H5Dwrite(set, type(Number()), H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) >= 0);
    H5Dclose(set);
    H5Pclose(creation);
    H5Sclose(space);
  }

  void add_attribute(const std::string& object, const char* name, const std::string& text) {
    const hid_t string = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(string, text.size());
    const hid_t attribute =
        H5Acreate_by_name(file_, object.c_str(), name, string, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    REQUIRE(H5Awrite(attribute, string, text.data()) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(string);
  }

  /// Metavision's type, with a filter that may be missing.
  void add_compound(const std::string& path, H5Z_filter_t filter) {
    const hsize_t rows = 10;
    const hid_t type = H5Tcreate(H5T_COMPOUND, 16), space = H5Screate_simple(1, &rows, nullptr);
    H5Tinsert(type, "x", 0, H5T_STD_U16LE);
    H5Tinsert(type, "y", 2, H5T_STD_U16LE);
    H5Tinsert(type, "p", 4, H5T_STD_I16LE);
    H5Tinsert(type, "t", 8, H5T_STD_I64LE);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(creation, 1, &rows);
    if (filter > 0) H5Pset_filter(creation, filter, H5Z_FLAG_OPTIONAL, 0, nullptr);
    H5Dclose(H5Dcreate2(file_, path.c_str(), type, space, groups_, creation, H5P_DEFAULT));
    H5Pclose(creation);
    H5Sclose(space);
    H5Tclose(type);
  }

  /// Replaces a column's first chunk by these bytes, as they are.
  void write_chunk(const std::string& path, const std::vector<char>& bytes) {
    const hid_t set = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    const hsize_t first = 0;
    REQUIRE(H5Dwrite_chunk(set, H5P_DEFAULT, 0, &first, bytes.size(), bytes.data()) >= 0);
    H5Dclose(set);
  }

 private:
  static hid_t type(std::uint8_t) { return H5T_STD_U8LE; }
  static hid_t type(std::int8_t) { return H5T_STD_I8LE; }
  static hid_t type(std::uint16_t) { return H5T_STD_U16LE; }
  static hid_t type(std::uint32_t) { return H5T_STD_U32LE; }
  static hid_t type(std::int64_t) { return H5T_STD_I64LE; }
  static hid_t type(std::uint64_t) { return H5T_STD_U64LE; }
  static hid_t type(double) { return H5T_IEEE_F64LE; }

  hid_t file_, groups_;
};

}  // namespace evbench::testing
