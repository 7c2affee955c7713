// A virtual lidar in a room from a file: what clients receive lies on the file's points.
#include "tests/e2e/gateway.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

namespace sweepcast::test {
namespace {

struct Point {
    double angle_deg, distance_mm;
};

std::vector<Point> load_points(const std::string& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    std::vector<Point> points;
    char comma = 0;
    for (Point point{}; file >> point.angle_deg >> comma >> point.distance_mm;) {
        points.push_back(point);
    }
    return points;
}

double angle_between(double a, double b) {
    const double apart = std::fabs(std::fmod(a - b + 540.0, 360.0) - 180.0);
    return apart;
}

/// How far the measured distance is from the nearest of the file's points within a degree; infinite
/// if there is none.
double distance_error(const std::vector<Point>& points, double angle_deg, double distance_mm) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& point : points) {
        if (angle_between(point.angle_deg, angle_deg) <= 1.0) {
            least = std::min(least, std::fabs(point.distance_mm - distance_mm));
        }
    }
    return least;
}

TEST(World, ReceivedPointsLieOnTheFilesPointsWithinTheNoise) {
    const std::string kitchen = std::string(SWEEPCAST_ROOMS) + "/kitchen.csv";
    constexpr double noise_mm = 5.0;
    const auto points = load_points(kitchen);
    ASSERT_GT(points.size(), 500U);
    VirtualLidarProcess lidar({"--world", kitchen, "--noise", "5"});
    GatewayProcess gateway({"--lidar", lidar.port});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();

    std::vector<double> errors;
    for (int i = 0; i < 5; ++i) {
        for (const auto& sample : client.next_sweep().scan.sweep.samples) {
            if (sample.distance.has_echo()) {
                errors.push_back(
                    distance_error(points, sample.angle.degrees(), sample.distance.millimetres())
                );
            }
        }
    }
    ASSERT_GT(errors.size(), 1000U);
    std::ranges::sort(errors);
    const auto quantile = [&](double q) {
        return errors[static_cast<std::size_t>(q * static_cast<double>(errors.size() - 1))];
    };
    std::cout << errors.size() << " points; error in mm: median " << quantile(0.5) << ", 95 % "
              << quantile(0.95) << ", largest " << errors.back() << "\n";
    // Gaussian noise: the nearest of several points within a degree is at most the noise away.
    EXPECT_LT(quantile(0.5), noise_mm);
    EXPECT_LT(quantile(0.95), 2 * noise_mm);
    EXPECT_LT(errors.back(), 6 * noise_mm);
}

}  // namespace
}  // namespace sweepcast::test
