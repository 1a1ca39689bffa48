// SPDX-License-Identifier: GPL-3.0-or-later
// The C example as a reader would run it.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>

#include "runtime_kit.h"

namespace {

struct Outcome {
    int status;
    std::string output;
};

Outcome relight(const std::string& arguments) {
    FILE* pipe = popen((std::string(AJAR_RELIGHT) + " " + arguments + " 2>&1").c_str(), "r");
    Outcome run{-1, ""};
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) run.output += static_cast<char>(c);
    run.status = WEXITSTATUS(pclose(pipe));
    return run;
}

/// A lamp over half of a page and a door over a quarter of it; both start off.
class RelightExample : public ::testing::Test {
protected:
    RelightExample() {
        scene_.add_page(16, 8);
        scene_.add_element("lamp", "light_set", 0.0f);
        scene_.add_element("door", "door", 0.0f);
        scene_.add_term({0}, kit::texel_range(0, 64), false, 50.0f);
        scene_.add_term({1}, kit::texel_range(96, 32), false, 50.0f);
        folder_.emplace(scene_);
    }
    std::string picture(const std::string& arguments) {
        const Outcome run = relight(folder_->path() + " " + arguments + " -o 0 " + folder_->file("out.ppm") + " 0.02");
        EXPECT_EQ(run.status, 0) << run.output;
        const std::vector<uint8_t> bytes = folder_->read("out.ppm");
        return {bytes.begin(), bytes.end()};
    }
    kit::TermScene scene_;
    std::optional<kit::PackageFolder> folder_;
};

TEST_F(RelightExample, ListsTheElements) {
    const Outcome run = relight(folder_->path() + " lamp=2");
    EXPECT_EQ(run.status, 0);
    EXPECT_NE(run.output.find("light set  lamp                     weight 2, reaches "), std::string::npos)
        << run.output;
    EXPECT_NE(run.output.find("door       door                     weight 0, reaches "), std::string::npos)
        << run.output;
}

TEST_F(RelightExample, WritesWhatTheWeightsSay) {
    const std::string dark = picture("lamp=0"), lit = picture("lamp=1"), open = picture("door@45/90");
    const std::string header = "P6\n16 8\n255\n";
    ASSERT_EQ(dark.size(), header.size() + 16 * 8 * 3);
    EXPECT_EQ(dark.compare(0, header.size(), header), 0);
    // Texels count from the bottom row, the picture's lines from the top.
    const auto sum = [&](const std::string& p, size_t line) {
        int total = 0;
        for (size_t i = 0; i < 48; ++i) total += static_cast<uint8_t>(p[header.size() + line * 48 + i]);
        return total;
    };
    EXPECT_GT(sum(lit, 7), sum(dark, 7));
    EXPECT_EQ(sum(lit, 0), sum(dark, 0));
    EXPECT_GT(sum(open, 0), sum(dark, 0));
    EXPECT_EQ(sum(open, 7), sum(dark, 7));
    EXPECT_EQ(picture("lamp:0,0,0 lamp=1"), dark);
}

TEST_F(RelightExample, SaysWhatIsWrong) {
    const Outcome unknown = relight(folder_->path() + " lantern=1"), nowhere = relight("/no/such/package"),
                  far = relight(folder_->path() + " door=2"), odd = relight(folder_->path() + " lamp");
    EXPECT_EQ(unknown.status, 1);
    EXPECT_NE(unknown.output.find("lantern"), std::string::npos);
    EXPECT_EQ(nowhere.status, 1);
    EXPECT_NE(nowhere.output.find("/no/such/package"), std::string::npos);
    EXPECT_EQ(far.status, 1);
    EXPECT_NE(far.output.find("out of range"), std::string::npos);
    EXPECT_EQ(odd.status, 2);
}

} // namespace
