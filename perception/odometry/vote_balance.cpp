#include "perception/odometry/vote_balance.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace sgraphs {
namespace {

constexpr double kThing_m = 0.5;     // radius, seen from above, of what may move as a whole
constexpr double kThingShare = 0.3;  // of what all else brings
constexpr int kMaxThings = 3;
constexpr size_t kCentres = 30;  // cells that are tried as a thing's middle

// What a cell brings through all patches that meet it, along one direction.
struct CellVote {
  const MapCell* cell;
  double information = 0;
  double factor = 1;

  double brings() const { return factor * information; }
};

// The cells that are met, in their order within the map, and which of them each vote meets.
struct Met {
  std::vector<CellVote> cells;
  std::vector<size_t> of_vote;  // void where the vote meets nothing
};

Met cellsOf(const std::vector<PatchVote>& votes) {
  std::vector<const MapCell*> cells;
  for (const PatchVote& vote : votes)
    if (vote.cell) cells.push_back(vote.cell);
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  Met met;
  for (const MapCell* cell : cells) met.cells.push_back({cell});
  for (const PatchVote& vote : votes) {
    const auto found = std::lower_bound(cells.begin(), cells.end(), vote.cell);
    met.of_vote.push_back(static_cast<size_t>(found - cells.begin()));
  }
  return met;
}

// The horizontal directions that the scan knows best and worst, as columns.
Eigen::Matrix2d principalDirections(const std::vector<PatchVote>& votes) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  for (const PatchVote& vote : votes) {
    if (!vote.cell) continue;
    const Eigen::Vector2d n = vote.cell->normal.head<2>();
    information += vote.weight * n * n.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(information).eigenvectors();
}

bool together(const CellVote& a, const CellVote& b) {
  return (a.cell->mean - b.cell->mean).head<2>().squaredNorm() < kThing_m * kThing_m;
}

std::vector<CellVote> strongestOf(std::vector<CellVote> cells, size_t count) {
  std::stable_sort(cells.begin(), cells.end(),
                   [](const CellVote& a, const CellVote& b) { return a.information > b.information; });
  cells.resize(std::min(cells.size(), count));
  return cells;
}

// Cuts the strongest thing to its share; false if there is none to cut.
bool cutStrongest(const std::vector<CellVote>& centres, std::vector<CellVote>& cells) {
  double total = 0, strongest = 0;
  const CellVote* centre = nullptr;
  for (const CellVote& cell : cells) total += cell.brings();
  for (const CellVote& candidate : centres) {
    double own = 0;
    for (const CellVote& cell : cells)
      if (together(cell, candidate)) own += cell.brings();
    if (own <= strongest) continue;
    strongest = own;
    centre = &candidate;
  }
  const double allowed = kThingShare * (total - strongest);
  // Nothing else speaks: then the one thing is better than none.
  if (!centre || strongest <= allowed || allowed <= 0) return false;
  for (CellVote& cell : cells)
    if (together(cell, *centre)) cell.factor *= allowed / strongest;
  return true;
}

}  // namespace

std::vector<double> balanceVotes(const std::vector<PatchVote>& votes, double cell_sigma_m) {
  const Eigen::Matrix2d directions = principalDirections(votes);
  const Met met = cellsOf(votes);
  std::vector<double> factors(votes.size(), 1.0);
  for (int k = 0; k < 2; ++k) {
    std::vector<CellVote> cells = met.cells;
    for (size_t i = 0; i < votes.size(); ++i) {
      if (!votes[i].cell) continue;
      const double along = votes[i].cell->normal.head<2>().dot(directions.col(k));
      cells[met.of_vote[i]].information += votes[i].weight * along * along;
    }
    const std::vector<CellVote> centres = strongestOf(cells, kCentres);
    for (int thing = 0; thing < kMaxThings; ++thing)
      if (!cutStrongest(centres, cells)) break;
    for (size_t i = 0; i < votes.size(); ++i)
      if (votes[i].cell) factors[i] = std::min(factors[i], cells[met.of_vote[i]].factor);
  }
  std::vector<double> weights(met.cells.size(), 0.0);
  for (size_t i = 0; i < votes.size(); ++i)
    if (votes[i].cell) weights[met.of_vote[i]] += votes[i].weight;
  // n patches of weight w on one cell: 1 / (1 / (n w) + cell_sigma^2), in equal shares.
  for (size_t i = 0; i < votes.size(); ++i)
    if (votes[i].cell) factors[i] /= 1.0 + cell_sigma_m * cell_sigma_m * weights[met.of_vote[i]];
  return factors;
}

}  // namespace sgraphs
