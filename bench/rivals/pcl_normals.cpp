//! The Point Cloud Library as a peer: normals and moving least squares, one thread, jobs from the standard input.
//
// Arguments: a file of points and a file for the answers, both doubles, three a row.

#include <pcl/features/normal_3d.h>
#include <pcl/pcl_config.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Rows = std::vector<std::array<double, 3>>;

static double cpu_seconds() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

static Cloud::Ptr read_points(const char *path) {
    Cloud::Ptr cloud(new Cloud);
    std::ifstream file(path, std::ios::binary);
    std::array<double, 3> p;
    while (file.read(reinterpret_cast<char *>(p.data()), sizeof p)) {
        cloud->emplace_back(float(p[0]), float(p[1]), float(p[2]));
    }
    return cloud;
}

// A search by radius for count 0.
static double normals(const Cloud::Ptr &cloud, double radius, int count, Rows &rows) {
    pcl::PointCloud<pcl::Normal> result;
    const double before = cpu_seconds();
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(cloud);
    estimation.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    if (count > 0) {
        estimation.setKSearch(count);
    } else {
        estimation.setRadiusSearch(radius);
    }
    estimation.compute(result);
    const double seconds = cpu_seconds() - before;
    for (const auto &n : result) {
        rows.push_back({n.normal_x, n.normal_y, n.normal_z});
    }
    return seconds;
}

static double mls(const Cloud::Ptr &cloud, double radius, Rows &rows) {
    Cloud result;
    const double before = cpu_seconds();
    pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointXYZ> projection;
    projection.setInputCloud(cloud);
    projection.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    projection.setSearchRadius(radius);
    projection.setPolynomialOrder(2);
    projection.setNumberOfThreads(1);
    projection.process(result);
    const double seconds = cpu_seconds() - before;
    for (const auto &p : result) {
        rows.push_back({p.x, p.y, p.z});
    }
    return seconds;
}

int main(int argc, char **argv) {
    if (argc != 3) {
        std::fprintf(stderr, "arguments: POINTS ANSWERS\n");
        return 2;
    }
    const Cloud::Ptr cloud = read_points(argv[1]);
    std::printf("{\"pcl\": \"%s\", \"compiler\": \"%s\"}\n", PCL_VERSION_PRETTY, __VERSION__);
    std::fflush(stdout);
    std::string job;
    double number;
    while (std::cin >> job >> number) {
        Rows rows;
        double seconds = -1;
        if (job == "normals_radius") {
            seconds = normals(cloud, number, 0, rows);
        } else if (job == "normals_count") {
            seconds = normals(cloud, 0, int(number), rows);
        } else if (job == "mls_order_2") {
            seconds = mls(cloud, number, rows);
        }
        if (seconds < 0) {
            std::printf("{\"error\": \"no job %s\"}\n", job.c_str());
        } else {
            std::ofstream(argv[2], std::ios::binary)
                .write(reinterpret_cast<const char *>(rows.data()), rows.size() * sizeof rows[0]);
            std::printf("{\"cpu\": %.9f, \"kind\": \"%s\"}\n", seconds, job[0] == 'n' ? "normals" : "points");
        }
        std::fflush(stdout);
    }
}
