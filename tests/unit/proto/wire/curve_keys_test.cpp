#include "proto/wire/curve_keys.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "proto/report/failure.hpp"
#include "tests/unit/proto/wire/test_keys.hpp"

namespace couplet::wire {

namespace {

namespace fs = std::filesystem;

class KeyFolder : public testing::Test {
 protected:
  KeyFolder() : path_(fs::path(testing::TempDir()) / "couplet-curve-keys") {
    fs::remove_all(path_);
    fs::create_directories(path_);
    own_ = make_key_pair(), peer_ = make_key_pair();
    write("solid-server.key", own_.secret_key + "\n");
    fs::permissions(path_ / "solid-server.key", fs::perms::owner_read);
    write("coupler.pub", peer_.public_key + "\n");
  }
  ~KeyFolder() override { fs::remove_all(path_); }

  void write(const std::string& name, const std::string& text) const {
    fs::remove(path_ / name);
    std::ofstream(path_ / name) << text;
  }
  void expect_refusal(const std::string& of, const std::string& because) const {
    try {
      read_curve_keys(path_, "solid-server", "coupler");
      ADD_FAILURE() << of << " was taken";
    } catch (const report::FileError& fault) {
      EXPECT_EQ(fault.where(), (path_ / of).string());
      EXPECT_NE(fault.sentence().find(because), std::string::npos) << fault.sentence();
    }
  }

  fs::path path_;
  KeyPair own_, peer_;
};

TEST_F(KeyFolder, GivesTheOwnPairAndThePublicKeyOfThePeer) {
  const CurveKeys keys = read_curve_keys(path_, "solid-server", "coupler");
  EXPECT_EQ(keys.secret_key, own_.secret_key);
  EXPECT_EQ(keys.public_key, own_.public_key);
  EXPECT_EQ(keys.peer_public_key, peer_.public_key);
}

TEST_F(KeyFolder, MustHoldBoth) {
  fs::remove(path_ / "coupler.pub");
  expect_refusal("coupler.pub", "cannot read");
  fs::remove(path_ / "solid-server.key");
  expect_refusal("solid-server.key", "cannot read");
}

TEST_F(KeyFolder, MustHoldKeys) {
  for (const char* wrong : {"", "short", "0000000000000000000000000000000000000000 and more",
                            "00000000000000000000\x01"
                            "0000000000000000000",
                            "00000000000000000000000000000000000000000"}) {
    write("coupler.pub", wrong);
    expect_refusal("coupler.pub", "holds no key");
  }
}

TEST_F(KeyFolder, MustKeepItsSecretFromOthers) {
  for (const fs::perms open : {fs::perms::group_read, fs::perms::others_read, fs::perms::others_write}) {
    fs::permissions(path_ / "solid-server.key", fs::perms::owner_read | open);
    expect_refusal("solid-server.key", "other users");
  }
}

}  // namespace

}  // namespace couplet::wire
