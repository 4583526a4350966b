#include "perception/free_space/clusters/narrowness.h"

#include <algorithm>
#include <tuple>

#include "perception/free_space/clusters/contacts.h"

namespace sgraphs {
namespace {

constexpr double kSameCut_m = 0.3;  // cuts nearer than this are the same

// Regions as they are after some joins; a count of 0 means that there are none.
class JoinedRegions {
 public:
  JoinedRegions(const StoreyGrid& grid, const CellLabels& labels, int32_t count)
      : grid_(grid), labels_(labels), sets_(count) {}

  DisjointSets& sets() { return sets_; }

  // Median width of a region behind a cut, parallel to it; `inward` points into the region.
  double widthBehind(const Cut& cut, int32_t label, const Eigen::Vector2d& inward) {
    constexpr double kFirst_m = 0.25, kStep_m = 0.15;  // from the reveal of a door on, to a metre
    constexpr int kSamples = 6;
    const Eigen::Vector2d along = (cut.right - cut.left).normalized();
    std::vector<double> widths_m;
    for (int k = 0; k < kSamples; ++k) {
      const Eigen::Vector2d p = cut.middle() + (kFirst_m + k * kStep_m) * inward;
      if (!isIn(p, label)) continue;
      const double far_m = 2 * cut.width() + 1;
      widths_m.push_back(reach(p, along, label, far_m) + reach(p, -along, label, far_m) + grid_.cell_m);
    }
    if (widths_m.empty()) return 0;
    const auto middle = widths_m.begin() + static_cast<std::ptrdiff_t>(widths_m.size() / 2);
    std::nth_element(widths_m.begin(), middle, widths_m.end());
    return *middle;
  }

  double relativeWidth(const Cut& cut, int32_t a, int32_t b) {
    const Eigen::Vector2d along = (cut.right - cut.left).normalized();
    const Eigen::Vector2d to_b(-along.y(), along.x());
    const double width_m = std::min(widthBehind(cut, a, -to_b), widthBehind(cut, b, to_b));
    return width_m > 0 ? cut.width() / width_m : 1.0;
  }

 private:
  bool isIn(const Eigen::Vector2d& p, int32_t label) {
    const int32_t at = labelAt(grid_, labels_, p);
    if (at == label || at == kNoLabel) return at == label;
    return sets_.size() > 0 && sets_.find(at) == sets_.find(label);
  }
  double reach(const Eigen::Vector2d& from, const Eigen::Vector2d& direction, int32_t label, double max_m) {
    const double step_m = 0.5 * grid_.cell_m;
    double length_m = 0;
    while (length_m < max_m && isIn(from + (length_m + step_m) * direction, label)) length_m += step_m;
    return length_m;
  }

  const StoreyGrid& grid_;
  const CellLabels& labels_;
  DisjointSets sets_;
};

// The ways between two regions, as if they were one: gaps along a line, and what stands between them.
bool isOneRoom(const FreeSpaceGraphConfig& config, const std::vector<Cut>& gaps, double side_clearance_m) {
  double free_m = 0;
  const Cut *first = &gaps.front(), *last = first;
  double span_m = 0;
  for (const Cut& a : gaps) {
    free_m += a.width();
    for (const Cut& b : gaps)
      if ((b.middle() - a.middle()).norm() > span_m) {
        span_m = (b.middle() - a.middle()).norm();
        first = &a;
        last = &b;
      }
  }
  const double line_m = span_m + 0.5 * (first->width() + last->width());
  return free_m > 0.5 * line_m && 0.5 * free_m > config.narrow_ratio * side_clearance_m;
}

}  // namespace

double relativeWidth(const StoreyGrid& grid, const CellLabels& labels, const Cut& cut, int32_t label) {
  return JoinedRegions(grid, labels, 0).relativeWidth(cut, label, label);
}

double widthLimit(const FreeSpaceGraphConfig& config, const std::vector<Cut>& former, const Cut& cut) {
  const bool was_cut = std::any_of(former.begin(), former.end(), [&cut](const Cut& old) {
    return old.narrows && (old.middle() - cut.middle()).norm() < kSameCut_m;
  });
  return was_cut ? config.kept_ratio : config.narrow_ratio;
}

void joinWhereWide(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, const std::vector<Cut>& former,
                   Regions& regions) {
  struct Way {
    Cut cut;
    int32_t a, b;
    double limit;
  };
  std::vector<Way> ways;
  for (const Contact& contact : contactsOf(grid, regions.labels)) {
    const auto cut = narrowestAt(grid, regions.labels, contact);
    // A chink in a wall is no way.
    if (cut && cut->width() >= config.min_passage_m)
      ways.push_back({*cut, contact.a, contact.b,
                      cut->width() <= config.max_passage_m ? widthLimit(config, former, *cut) : 0});
  }
  // The widest first: a join widens what is behind other cuts, and a door into a corridor is judged by the
  // corridor, not by a piece of it.
  std::stable_sort(ways.begin(), ways.end(),
                   [](const Way& a, const Way& b) { return a.cut.width() > b.cut.width(); });
  JoinedRegions joined(grid, regions.labels, regions.count);
  DisjointSets& sets = joined.sets();
  for (bool changed = true; changed;) {
    changed = false;
    for (const Way& way : ways) {
      const int32_t a = sets.find(way.a), b = sets.find(way.b);
      if (a == b || joined.relativeWidth(way.cut, way.a, way.b) < way.limit) continue;
      sets.join(std::min(a, b), std::max(a, b));
      changed = true;
    }
  }
  joinRegions(sets, regions);
}

void joinThroughParallelGaps(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, Regions& regions) {
  // A join may lay gaps side by side that were not before.
  for (int round = 0; round < 4; ++round) {
    const std::vector<Contact> contacts = contactsOf(grid, regions.labels);
    if (std::adjacent_find(contacts.begin(), contacts.end(), [](const Contact& a, const Contact& b) {
          return std::tie(a.a, a.b) == std::tie(b.a, b.b);
        }) == contacts.end())
      return;
    const std::vector<double> widest = widestClearances(grid, regions);
    DisjointSets sets(regions.count);
    bool joined = false;
    for (size_t begin = 0; begin < contacts.size();) {
      const int32_t a = contacts[begin].a, b = contacts[begin].b;
      std::vector<Cut> gaps;
      size_t end = begin;
      for (; end < contacts.size() && std::tie(contacts[end].a, contacts[end].b) == std::tie(a, b); ++end)
        if (const auto cut = narrowestAt(grid, regions.labels, contacts[end]);
            cut && cut->width() >= config.min_passage_m)
          gaps.push_back(*cut);
      begin = end;
      const double side_m = std::min(widest[static_cast<size_t>(a)], widest[static_cast<size_t>(b)]);
      if (gaps.size() < 2 || sets.find(a) == sets.find(b) || !isOneRoom(config, gaps, side_m)) continue;
      sets.join(std::min(sets.find(a), sets.find(b)), std::max(sets.find(a), sets.find(b)));
      joined = true;
    }
    if (!joined) return;
    joinRegions(sets, regions);
  }
}

}  // namespace sgraphs
