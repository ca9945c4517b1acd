// The turnstile: strict alternation, and errors that leave from either side.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "embacle/coupling/turnstile.hpp"

namespace embacle::coupling {
namespace {

TEST(Turnstile, SidesAlternateAtYields) {
  Turnstile turnstile;
  std::string order;
  const auto side = [&](char name) {
    return [&turnstile, &order, name] {
      for (int i = 0; i < 3; ++i) {
        order += name;
        turnstile.yield();
      }
    };
  };
  turnstile.run(side('a'), side('b'));
  EXPECT_EQ(order, "ababab");
}

TEST(Turnstile, YieldReturnsAtOnceAfterTheOtherSideHasEnded) {
  Turnstile turnstile;
  std::string order;
  turnstile.run([&] { order += 'a'; },
                [&] {
                  for (int i = 0; i < 1000; ++i) turnstile.yield();
                  order += 'b';
                });
  EXPECT_EQ(order, "ab");
  turnstile.run(
      [&] {
        for (int i = 0; i < 1000; ++i) turnstile.yield();
        order += 'a';
      },
      [&] { order += 'b'; });
  EXPECT_EQ(order, "abba");
}

TEST(Turnstile, ErrorOfTheFirstSideInterruptsTheSecond) {
  Turnstile turnstile;
  bool interrupted = false;
  bool went_on = false;
  const auto first = [&] {
    turnstile.yield();
    throw std::runtime_error("water broke");
  };
  const auto second = [&] {
    try {
      for (;;) turnstile.yield();
    } catch (const Turnstile::Interrupted&) {
      interrupted = true;
      throw;
    }
    went_on = true;
  };
  try {
    turnstile.run(first, second);
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "water broke");
  }
  EXPECT_TRUE(interrupted);
  EXPECT_FALSE(went_on);
}

TEST(Turnstile, ErrorOfTheSecondSideInterruptsTheFirst) {
  Turnstile turnstile;
  bool interrupted = false;
  const auto first = [&] {
    try {
      for (;;) turnstile.yield();
    } catch (const Turnstile::Interrupted&) {
      interrupted = true;
      throw;
    }
  };
  EXPECT_THROW(turnstile.run(first, [] { throw std::logic_error("solids broke"); }), std::logic_error);
  EXPECT_TRUE(interrupted);
}

TEST(Turnstile, ErrorBeforeTheSecondSideBegan) {
  Turnstile turnstile;
  bool began = false;
  EXPECT_THROW(turnstile.run([] { throw std::runtime_error("early"); }, [&] { began = true; }), std::runtime_error);
  EXPECT_FALSE(began);
}

}  // namespace
}  // namespace embacle::coupling
