// A generated C solver in a C++ program:
//
//     robotc ik kr6.urdf --base base --tip tool -o kr6.c
//     cc -c -O2 -ffp-contract=off kr6.c && c++ -std=c++11 main.cpp kr6.o -lm -o reach && ./reach
#include <cmath>
#include <cstdio>
#include <vector>

#include "kr6.h"

namespace {

struct Joints {
    double values[KR6_VARIABLES];
};

// All joint vectors that reach a pose.
std::vector<Joints> solve(const kr6_frame &base_from_tip)
{
    kr6_solutions found;
    kr6_solve(&base_from_tip, nullptr, &found);
    std::vector<Joints> all;
    for (int i = 0; i < found.count; i++) {
        Joints joints;
        for (int k = 0; k < KR6_VARIABLES; k++) joints.values[k] = found.values[i][k];
        all.push_back(joints);
    }
    return all;
}

double distance(const kr6_frame &a, const kr6_frame &b)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        sum += (a.position[i] - b.position[i]) * (a.position[i] - b.position[i]);
        for (int k = 0; k < 3; k++) sum += (a.rotation[i][k] - b.rotation[i][k]) * (a.rotation[i][k] - b.rotation[i][k]);
    }
    return std::sqrt(sum);
}

// How many members of the families through a solution were followed; 0 if one of them does not reach the pose.
int follow_families(const kr6_frame &base_from_tip, const double *solution)
{
    kr6_family families[KR6_VARIABLES];
    int followed = 0;
    const int count = kr6_families(&base_from_tip, solution, families);
    for (int k = 0; k < count; k++) {
        for (double part : { 0.0, 0.3, 0.7, 1.0 }) {
            const double t = families[k].interval[0] + part * (families[k].interval[1] - families[k].interval[0]);
            double member[KR6_VARIABLES];
            kr6_frame reached;
            if (!kr6_family_member(&base_from_tip, solution, &families[k], t, member)) return 0;
            kr6_forward(member, &reached);
            if (!(distance(reached, base_from_tip) < 1e-8)) return 0;
            followed++;
        }
    }
    return followed;
}

} // namespace

int main()
{
    const double start[KR6_VARIABLES] = { 0.3, -1.2, 1.4, 0.5, 0.9, 2.0 };
    kr6_frame wanted;
    kr6_forward(start, &wanted);
    double worst = 0.0;
    const std::vector<Joints> all = solve(wanted);
    for (const Joints &joints : all) {
        kr6_frame reached;
        kr6_forward(joints.values, &reached);
        worst = std::fmax(worst, distance(reached, wanted));
        for (double value : joints.values) std::printf("%8.4f", value);
        std::printf("\n");
    }
    std::printf("%d solutions, all %s\n", static_cast<int>(all.size()), worst < 1e-9 ? "reach the pose" : "but some do not reach the pose");
    // At its wrist singularity the fourth and the sixth joint move against each other.
    const double lined_up[KR6_VARIABLES] = { 0.3, -1.2, 1.4, 0.5, 0.0, 2.0 };
    kr6_forward(lined_up, &wanted);
    int members = 0;
    for (const Joints &joints : solve(wanted)) members += follow_families(wanted, joints.values);
    std::printf("%d members of families at a singular pose\n", members);
    return worst < 1e-9 && !all.empty() && members > 0 ? 0 : 1;
}
