#include <hdf5.h>

#include "core/events/formats.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;

namespace {

/// A group with events, in the library's old kind of groups: their names are in a "HEAP".
std::string write_events(const testing::TemporaryFolder& folder) {
  const std::string path = folder.file("events.h5");
  const hsize_t rows = 3;
  const int numbers[] = {1, 2, 3};
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "events", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(1, &rows, nullptr);
  for (const char* column : {"x", "y", "t", "p"}) {
    const hid_t set = H5Dcreate2(group, column, H5T_NATIVE_INT, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers);
    H5Dclose(set);
  }
  H5Sclose(space);
  H5Gclose(group);
  H5Fclose(file);
  return path;
}

}  // namespace

TEST_CASE("An HDF5 file on which some versions of the library crash is refused with a sentence") {
  const testing::TemporaryFolder folder;
  std::string content = testing::read_file(write_events(folder));
  CHECK_NOTHROW(open_events(folder.file("events.h5")));
  const std::size_t heap = content.find("HEAP"), address = heap + 24;
  REQUIRE(heap != std::string::npos);
  content.replace(address, 8, 8, '\xFF');
  const std::string broken = folder.write("broken.h5", content);
  CHECK_THROWS_WITH(open_events(broken), Catch::Matchers::StartsWith(broken + ": HDF5 cannot read this"));
}

TEST_CASE("What the HDF5 library itself refuses, its trial leaves to it") {
  const testing::TemporaryFolder folder;
  const std::string content = testing::read_file(write_events(folder));
  const std::string cut = folder.write("cut.h5", content.substr(0, content.size() / 2));
  CHECK_THROWS_WITH(open_events(cut), Catch::Matchers::StartsWith(cut + ": HDF5 cannot read this"));
}
