#include "drivers/velodyne/packet_grouper.h"

#include <utility>

namespace sgraphs {

std::optional<PacketGroup> PacketGrouper::step(const VelodynePacket& packet) {
  open_.packets.push_back(packet);
  const bool cut = cutter_.step(packet.bytes) >= 0;
  if (!cut && open_.packets.size() < kMaxPackets) return std::nullopt;
  return close(cut);
}

std::optional<PacketGroup> PacketGrouper::flush() {
  if (open_.packets.empty()) return std::nullopt;
  return close(false);
}

PacketGroup PacketGrouper::close(bool last_part) {
  open_.last_part = last_part;
  PacketGroup next;
  next.revolution = open_.revolution + last_part;
  next.part = last_part ? 0 : open_.part + 1;
  return std::exchange(open_, std::move(next));
}

}  // namespace sgraphs
