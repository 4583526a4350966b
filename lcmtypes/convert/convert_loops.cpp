#include "lcmtypes/convert/chunks.h"
#include "lcmtypes/convert/convert.h"
#include "lcmtypes/convert/convert_layers.h"

namespace sgraphs {
namespace {

bool isShare(double x) {
  return x >= 0 && x <= 1;  // false for NaN
}

loop_closure_t toMessage(const LoopClosure& loop) {
  loop_closure_t m{};
  m.id = loop.id.value;
  m.pose = toMessage(loop.pose);
  m.overlap = loop.overlap;
  m.inlier_share = loop.inlier_share;
  return m;
}

std::optional<LoopClosure> fromMessage(const loop_closure_t& m) {
  const std::optional<RelativePose> pose = fromMessage(m.pose);
  if (m.id < 0 || !pose || pose->kind != RelativePoseKind::kLoop || pose->from >= pose->to ||
      !isShare(m.overlap) || !isShare(m.inlier_share))
    return std::nullopt;
  return LoopClosure{LoopId{m.id}, *pose, m.overlap, m.inlier_share};
}

}  // namespace

std::vector<loop_closures_t> toMessages(const LoopClosures& loops, const std::string& why_not) {
  loop_closures_t head{};
  head.header.utime = loops.time.us;
  head.round = loops.round;
  head.why_not = why_not;
  head.searching = loops.searching ? 1 : 0;
  ChunkFiller<loop_closures_t> chunks(head);
  for (const LoopClosure& loop : loops.accepted) chunks.add(&loop_closures_t::accepted, toMessage(loop));
  for (const LoopId id : loops.withdrawn) chunks.add(&loop_closures_t::withdrawn, id.value);
  return chunks.finish([](loop_closures_t& m) {
    m.num_accepted = static_cast<int32_t>(m.accepted.size());
    m.num_withdrawn = static_cast<int32_t>(m.withdrawn.size());
  });
}

std::optional<LoopClosures> fromMessages(std::span<const loop_closures_t> chunks) {
  if (chunks.empty() || chunks.front().round < 0) return std::nullopt;
  LoopClosures loops{.round = chunks.front().round,
                     .time = Time{chunks.front().header.utime},
                     .accepted = {},
                     .withdrawn = {},
                     .searching = chunks.front().searching != 0};
  for (const loop_closures_t& m : chunks) {
    if (m.round != loops.round) return std::nullopt;
    for (const loop_closure_t& record : m.accepted) {
      const std::optional<LoopClosure> loop = fromMessage(record);
      if (!loop || (!loops.accepted.empty() && loop->id <= loops.accepted.back().id)) return std::nullopt;
      loops.accepted.push_back(*loop);
    }
    for (const int64_t id : m.withdrawn) {
      if (id < 0 || (!loops.withdrawn.empty() && LoopId{id} <= loops.withdrawn.back())) return std::nullopt;
      loops.withdrawn.push_back(LoopId{id});
    }
  }
  return loops;
}

}  // namespace sgraphs
