#include "core/io/sha256.hpp"

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;

TEST_CASE("SHA-256 gives the digests of FIPS 180-4's examples, in one part or many") {
  CHECK(sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  Sha256 hash;
  hash.add("a");
  hash.add("");
  hash.add("bc");
  CHECK(hash.hex() == sha256("abc"));
}

TEST_CASE("A file's digest is that of its bytes, and an unreadable file is refused") {
  const testing::TemporaryFolder folder;
  const std::string bytes(3000000, 'x');
  CHECK(sha256_file(folder.write("a", bytes)) == sha256(bytes));
  CHECK_THROWS_AS(sha256_file(folder.file("none")), InputError);
}
