// SPDX-License-Identifier: GPL-3.0-or-later
// The leanest run of a block that Debian's Siconos allows: a C++ program on its kernel and its solver, with every block vertex against the plane of the
// terrain facet below it, in double precision, and no output. Built and called by compare_siconos.sh, not by CMake.
//
// Usage: siconos_blocks FOLDER TERRAIN OUT.csv NAME shipped|orthogonal STEP TIME E MU MU_R TOLERANCE [PATH.csv]
//   shipped: contact frames as Siconos builds them; orthogonal: the same with the tangents made orthogonal to the normal
//   PATH.csv: where the first block was, every tenth step, as in the references
#include "core_clock.hpp"

#include <NewtonImpactRollingFrictionNSL.hpp>
#include <RollingFrictionContact.hpp>
#include <SiconosKernel.hpp>
#include <SolverOptions.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Vec = std::array<double, 3>;

constexpr double kGravity = 9.80665;  ///< [m/s^2]
constexpr double kWatch =
    0.06;  ///< vertices below this gap are interactions: farther than a block falls in a step and a half at 40 m/s [m]
constexpr double kForget = 0.08;    ///< and above this one no more [m]
constexpr double kRestHead = 1e-6;  ///< kinetic energy per weight below which the run may end, as in Scree [m]
constexpr double kRestTime = 0.05;  ///< how long it must stay so [s]
constexpr double kStart = -80.0;    ///< easting of s = 0 [m]
constexpr std::array<double, 2> kLines{39.5, 48.5};  ///< s where speed is taken [m]

double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::vector<std::vector<double>> read_csv(const std::string& path) {
    std::ifstream in(path);
    std::string line, field;
    std::getline(in, line);
    std::vector<std::vector<double>> rows;
    while (std::getline(in, line)) {
        std::istringstream fields(line);
        rows.emplace_back();
        while (std::getline(fields, field, ',')) rows.back().push_back(std::strtod(field.c_str(), nullptr));
    }
    if (rows.empty()) throw std::runtime_error(path + ": no rows");
    return rows;
}

/// Heights of nodes, each cell split along (i+1, j)-(i, j+1).
class Terrain {
public:
    explicit Terrain(const std::string& path) {
        std::ifstream in(path);
        std::string word;
        double nodata = 0.0;
        in >> word >> columns_ >> word >> rows_ >> word >> x_ >> word >> y_ >> word >> cell_ >> word >> nodata;
        heights_.resize(static_cast<std::size_t>(columns_ * rows_));
        for (int j = rows_ - 1; j >= 0; --j)
            for (int i = 0; i < columns_; ++i) in >> heights_[static_cast<std::size_t>(j * columns_ + i)];
        if (!in) throw std::runtime_error(path + ": short file");
    }
    /// Distance of a point from the plane of the facet below it, and the normal of that plane.
    double gap(const Vec& p, Vec& normal) const {
        const double u = (p[0] - x_) / cell_, v = (p[1] - y_) / cell_;
        const int i = std::clamp(static_cast<int>(std::floor(u)), 0, columns_ - 2);
        const int j = std::clamp(static_cast<int>(std::floor(v)), 0, rows_ - 2);
        const double a = u - i, b = v - j;
        const double sw = at(i, j), se = at(i + 1, j), nw = at(i, j + 1), ne = at(i + 1, j + 1);
        const bool lower = a + b < 1.0;
        const double dx = (lower ? se - sw : ne - nw) / cell_, dy = (lower ? nw - sw : ne - se) / cell_;
        const double height =
            lower ? sw + a * (se - sw) + b * (nw - sw) : ne + (1.0 - a) * (nw - ne) + (1.0 - b) * (se - ne);
        const double length = std::sqrt(1.0 + dx * dx + dy * dy);
        normal = {-dx / length, -dy / length, 1.0 / length};
        return (p[2] - height) / length;
    }

private:
    double at(int i, int j) const { return heights_[static_cast<std::size_t>(j * columns_ + i)]; }
    int columns_ = 0, rows_ = 0;
    double x_ = 0.0, y_ = 0.0, cell_ = 1.0;
    std::vector<double> heights_;
};

/// Body to world by the quaternion in q(3..6).
Vec turned(const SiconosVector& q, const Vec& p) {
    const double w = q(3);
    const Vec u{q(4), q(5), q(6)};
    const Vec t = cross(u, p), t2 = cross(u, t);
    return {p[0] + 2.0 * (w * t[0] + t2[0]), p[1] + 2.0 * (w * t[1] + t2[1]), p[2] + 2.0 * (w * t[2] + t2[2])};
}
Vec turned_back(const SiconosVector& q, const Vec& p) {
    const double w = q(3);
    const Vec u{-q(4), -q(5), -q(6)};
    const Vec t = cross(u, p), t2 = cross(u, t);
    return {p[0] + 2.0 * (w * t[0] + t2[0]), p[1] + 2.0 * (w * t[1] + t2[1]), p[2] + 2.0 * (w * t[2] + t2[2])};
}

double largest_skew = 0.0;  ///< largest |T1.N| of a frame that Siconos built in this run [-]

/// Siconos' own relation for rolling friction, told where the vertex is and which plane is below.
class VertexOnFacet : public NewtonEuler5DR {
public:
    VertexOnFacet(const Terrain& terrain, const Vec& vertex, bool orthogonal)
        : terrain_(terrain), vertex_(vertex), orthogonal_(orthogonal) {}

    double gap_of(const SiconosVector& q) {
        const Vec arm = turned(q, vertex_);
        point_ = {arm[0] + q(0), arm[1] + q(1), arm[2] + q(2)};
        return terrain_.gap(point_, normal_);
    }
    void computeh(double, const BlockVector& q0, SiconosVector& y) override {
        const double gap = gap_of(*q0.getAllVect()[0]);
        for (unsigned int k = 0; k < 3; ++k) {
            (*_Pc1)(k) = point_[k];
            (*_Pc2)(k) = point_[k] - gap * normal_[k];
            (*_Nc)(k) = normal_[k];
        }
        y.zero();
        y(0) = gap;
    }
    void computeJachqT(Interaction& inter, SP::BlockVector q0) override {
        NewtonEuler5DR::computeJachqT(inter, q0);
        SimpleMatrix& h = *_jachqT;
        Vec t1{h(1, 0), h(1, 1), h(1, 2)};
        const double skew = dot(t1, normal_);
        largest_skew = std::max(largest_skew, std::abs(skew));
        if (!orthogonal_) return;
        for (unsigned int k = 0; k < 3; ++k) t1[k] -= skew * normal_[k];
        const double length = std::sqrt(dot(t1, t1));
        for (double& c : t1) c /= length;
        const SiconosVector& q = *q0->getAllVect()[0];
        const Vec arm{point_[0] - q(0), point_[1] - q(1), point_[2] - q(2)};
        set_tangent(h, 1, 3, t1, arm, q);
        set_tangent(h, 2, 4, cross(normal_, t1), arm, q);
    }

private:
    static void set_tangent(SimpleMatrix& h, unsigned int slip, unsigned int roll, const Vec& t, const Vec& arm,
                            const SiconosVector& q) {
        const Vec turning = turned_back(q, cross(arm, t)), rolling = turned_back(q, t);
        for (unsigned int k = 0; k < 3; ++k) {
            h(slip, k) = t[k];
            h(slip, k + 3) = turning[k];
            h(roll, k) = 0.0;
            h(roll, k + 3) = rolling[k];
        }
    }
    const Terrain& terrain_;
    Vec vertex_, point_{}, normal_{0.0, 0.0, 1.0};
    bool orthogonal_;
};

/// Keeps the vertices near the ground as interactions, the way Siconos' own collision managers do.
class NearVertices : public InteractionManager {
public:
    NearVertices(const Terrain& terrain, const std::vector<Vec>& vertices, bool orthogonal, SP::NonSmoothLaw law,
                 SP::NewtonEulerDS body)
        : law_(law), body_(body), linked_(vertices.size()) {
        for (const Vec& v : vertices) relations_.push_back(std::make_shared<VertexOnFacet>(terrain, v, orthogonal));
    }
    void updateInteractions(SP::Simulation simulation) override {
        const SiconosVector& q = *body_->q();
        for (std::size_t v = 0; v < relations_.size(); ++v) {
            const double gap = relations_[v]->gap_of(q);
            if (!linked_[v] && gap < kWatch) {
                linked_[v] = std::make_shared<Interaction>(law_, relations_[v]);
                simulation->link(linked_[v], body_);
            } else if (linked_[v] && gap > kForget) {
                simulation->unlink(linked_[v]);
                linked_[v].reset();
            }
        }
    }

private:
    SP::NonSmoothLaw law_;
    SP::NewtonEulerDS body_;
    std::vector<std::shared_ptr<VertexOnFacet>> relations_;
    std::vector<SP::Interaction> linked_;
};

struct Law {
    double e = 0.0, mu = 0.0, mu_r = 0.0, tolerance = 1e-4;
};

struct Outcome {
    double stop = 0.0, lateral = 0.0, largest_speed = 0.0, time = 0.0;
    std::array<double, 2> line_speed{std::nan(""), std::nan("")};
    long steps = 0;
};

Outcome throw_block(const std::vector<double>& row, const std::vector<Vec>& vertices, const Terrain& terrain,
                    bool orthogonal, double h, double time, const Law& law, std::ostream* path) {
    auto q0 = std::make_shared<SiconosVector>(7), v0 = std::make_shared<SiconosVector>(6);
    for (unsigned int k = 0; k < 7; ++k) (*q0)(k) = row[k + 1];
    const double mass = row[8];
    auto inertia = std::make_shared<SimpleMatrix>(3, 3);
    for (unsigned int k = 0; k < 3; ++k) (*inertia)(k, k) = row[9 + k];
    auto body = std::make_shared<NewtonEulerDS>(q0, v0, mass, inertia);
    auto weight = std::make_shared<SiconosVector>(3);
    (*weight)(2) = -mass * kGravity;
    body->setFExtPtr(weight);

    auto system = std::make_shared<NonSmoothDynamicalSystem>(0.0, time);
    system->insertDynamicalSystem(body);
    auto nonsmooth = std::make_shared<NewtonImpactRollingFrictionNSL>(law.e, 0.0, law.mu, law.mu_r, 5);
    auto scheme = std::make_shared<MoreauJeanOSI>(0.5);
    auto problem = std::make_shared<RollingFrictionContact>(5);
    problem->numericsSolverOptions()->dparam[SICONOS_DPARAM_TOL] = law.tolerance;
    problem->numericsSolverOptions()->iparam[SICONOS_IPARAM_MAX_ITER] = 10000;
    problem->setKeepLambdaAndYState(true);
    auto simulation =
        std::make_shared<TimeStepping>(system, std::make_shared<TimeDiscretisation>(0.0, h), scheme, problem);
    simulation->insertInteractionManager(
        std::make_shared<NearVertices>(terrain, vertices, orthogonal, nonsmooth, body));
    simulation->setNewtonOptions(SICONOS_TS_NONLINEAR);
    simulation->setNewtonMaxIteration(
        1);  // one linearised step, the cheapest, and the scheme of the references and of Scree
    simulation->setWarnOnNonConvergence(false);
    simulation->setCheckSolverFunction([](int, Simulation*) {});  // what is above the tolerance is kept

    Outcome o;
    const auto& q = *body->q();
    const auto& v = *body->twist();
    const auto speed = [&] { return std::sqrt(v(0) * v(0) + v(1) * v(1) + v(2) * v(2)); };
    double still = 0.0;
    while (simulation->hasNextEvent() && still < kRestTime) {
        const double before = q(0), speed_before = speed();
        simulation->computeOneStep();
        simulation->nextStep();
        simulation->clearNSDSChangeLog();
        ++o.steps;
        o.largest_speed = std::max(o.largest_speed, speed());
        for (std::size_t k = 0; k < kLines.size(); ++k) {
            const double x = kStart + kLines[k];
            if (std::isnan(o.line_speed[k]) && before < x && q(0) >= x)
                o.line_speed[k] = speed_before + (x - before) / (q(0) - before) * (speed() - speed_before);
        }
        double energy = 0.5 * mass * speed() * speed();
        for (unsigned int k = 0; k < 3; ++k) energy += 0.5 * row[9 + k] * v(3 + k) * v(3 + k);
        still = energy < kRestHead * mass * kGravity && o.steps * h > 0.5 ? still + h : 0.0;
        if (path && o.steps % 10 == 0)
            *path << static_cast<double>(o.steps) * h << ',' << q(0) << ',' << q(1) << ',' << q(2) << '\n';
    }
    o.stop = q(0) - kStart;
    o.lateral = std::abs(q(1));
    o.time = static_cast<double>(o.steps) * h;
    return o;
}

int run(int argc, char** argv) {
    if (argc < 12) throw std::runtime_error("see the usage at the top of siconos_blocks.cpp");
    const std::string folder = argv[1], name = argv[4];
    const Terrain terrain(argv[2]);
    std::ofstream out(argv[3]), path;
    if (argc > 12) path.open(argv[12]);
    out << "model,block,stop_s,abs_y,v_max,v_at_s39_5,v_at_s48_5,t_end\n" << std::setprecision(10);
    path << "t,x,y,z\n" << std::setprecision(15);
    const auto number = [&](int k) { return std::strtod(argv[k], nullptr); };
    const Law law{number(8), number(9), number(10), number(11)};
    long steps = 0, blocks = 0;
    scree::bench::WorkMeter meter;
    for (const auto& row : read_csv(folder + "/blocks.csv")) {
        std::array<char, 32> hull{};
        std::snprintf(hull.data(), hull.size(), "/hull_%02d.csv", static_cast<int>(row.at(0)));
        std::vector<Vec> vertices;
        for (const auto& p : read_csv(folder + hull.data())) vertices.push_back({p.at(0), p.at(1), p.at(2)});
        Outcome o;
        meter.measure([&] {
            o = throw_block(row, vertices, terrain, std::string(argv[5]) == "orthogonal", number(6), number(7), law,
                            blocks == 0 && path.is_open() ? &path : nullptr);
        });
        out << name << ',' << row[0] << ',' << o.stop << ',' << o.lateral << ',' << o.largest_speed << ','
            << o.line_speed[0] << ',' << o.line_speed[1] << ',' << o.time << std::endl;
        steps += o.steps;
        ++blocks;
    }
    const auto per_block = [&](double sum) { return sum / static_cast<double>(blocks); };
    std::printf(
        "blocks %ld\ncpu_s_per_block %.6g\nadditions_per_block %.6g\nsteps_per_block %.1f\nlargest_frame_skew %.4f\n",
        blocks, per_block(meter.seconds()), per_block(meter.additions()), per_block(static_cast<double>(steps)),
        largest_skew);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& e) {
        std::cerr << "siconos_blocks: " << e.what() << '\n';
    } catch (...) {
        std::cerr << "siconos_blocks: an exception of Siconos\n";
    }
    return 4;
}
