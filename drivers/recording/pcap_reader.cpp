#include "drivers/recording/pcap_reader.h"

#include <pcap/pcap.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr uint16_t kIpv4 = 0x0800, kVlan = 0x8100, kProviderVlan = 0x88A8;
constexpr uint8_t kUdp = 17;
constexpr size_t kUdpHeaderBytes = 8;

uint16_t big16(const uint8_t* p) {
  return static_cast<uint16_t>(p[0] << 8 | p[1]);
}

// Where the link layer's header says what follows, and where that begins.
struct LinkLayer {
  size_t type_offset;
  size_t bytes;
};

std::optional<LinkLayer> linkLayer(int type) {
  switch (type) {
    case DLT_EN10MB:
      return LinkLayer{12, 14};
    case DLT_LINUX_SLL:
      return LinkLayer{14, 16};
    case DLT_LINUX_SLL2:
      return LinkLayer{0, 20};
    case DLT_RAW:
      return LinkLayer{0, 0};
    default:
      return std::nullopt;
  }
}

// Offset of the IPv4 header; nothing if the frame carries something else.
std::optional<size_t> findIpv4(const uint8_t* frame, size_t size, int link_type) {
  const LinkLayer link = *linkLayer(link_type);
  if (size < link.bytes + 20) return std::nullopt;
  size_t at = link.bytes;
  if (link.bytes > 0) {
    uint16_t type = big16(frame + link.type_offset);
    while (type == kVlan || type == kProviderVlan) {
      if (at + 4 + 20 > size) return std::nullopt;
      type = big16(frame + at + 2);
      at += 4;
    }
    if (type != kIpv4) return std::nullopt;
  }
  return frame[at] >> 4 == 4 ? std::optional(at) : std::nullopt;
}

}  // namespace

void PcapReader::Closer::operator()(pcap* handle) const {
  pcap_close(handle);
}

PcapReader::PcapReader(const std::string& path) : path_(path) {
  std::error_code error;
  file_bytes_ = static_cast<int64_t>(std::filesystem::file_size(path, error));
  if (error) throw Error("cannot read capture '" + path + "': " + error.message());
  if (file_bytes_ == 0) throw Error("capture '" + path + "' is empty: record or copy it again");
  char message[PCAP_ERRBUF_SIZE] = "";
  handle_.reset(pcap_open_offline(path.c_str(), message));
  if (!handle_)
    throw Error("'" + path + "' is no pcap or pcapng file (" + message +
                "): a raw stream of packets goes with --raw");
  link_type_ = pcap_datalink(handle_.get());
  if (!linkLayer(link_type_)) {
    const char* name = pcap_datalink_val_to_name(link_type_);
    throw Error("capture '" + path + "' is of link type " +
                (name ? std::string(name) : std::to_string(link_type_)) +
                ": capture on an Ethernet interface");
  }
}

PcapReader::~PcapReader() = default;

double PcapReader::progress() const {
  const long at = std::ftell(pcap_file(handle_.get()));
  return at < 0 ? 0 : static_cast<double>(at) / static_cast<double>(file_bytes_);
}

std::optional<UdpDatagram> PcapReader::next() {
  pcap_pkthdr* header = nullptr;
  const uint8_t* frame = nullptr;
  for (;;) {
    const int status = pcap_next_ex(handle_.get(), &header, &frame);
    if (status != 1) {
      if (status == PCAP_ERROR) damage_ = pcap_geterr(handle_.get());
      return std::nullopt;
    }
    ++counts_.frames;
    std::optional<UdpDatagram> datagram = parse(frame, header->caplen, header->len);
    if (!datagram) continue;
    datagram->captured = Time{static_cast<int64_t>(header->ts.tv_sec) * 1'000'000 + header->ts.tv_usec};
    return datagram;
  }
}

std::optional<UdpDatagram> PcapReader::parse(const uint8_t* frame, size_t captured, size_t on_wire) {
  const std::optional<size_t> ip_offset = findIpv4(frame, captured, link_type_);
  if (!ip_offset) return std::nullopt;
  const uint8_t* ip = frame + *ip_offset;
  const size_t ip_header = 4 * static_cast<size_t>(ip[0] & 0x0F);
  const size_t available = captured - *ip_offset;
  if (ip[9] != kUdp || ip_header < 20) return std::nullopt;
  constexpr uint16_t kMoreFragments = 0x2000, kFragmentOffset = 0x1FFF;
  if (big16(ip + 6) & (kMoreFragments | kFragmentOffset)) {
    ++counts_.fragments;
    return std::nullopt;
  }
  if (available < ip_header + kUdpHeaderBytes) {
    ++counts_.cut_frames;
    return std::nullopt;
  }
  const uint8_t* udp = ip + ip_header;
  const size_t udp_bytes = big16(udp + 4);
  if (udp_bytes < kUdpHeaderBytes) return std::nullopt;
  if (available < ip_header + udp_bytes) {
    counts_.cut_frames += captured < on_wire;
    return std::nullopt;
  }
  ++counts_.udp;
  UdpDatagram datagram;
  datagram.source_address = static_cast<uint32_t>(big16(ip + 12)) << 16 | big16(ip + 14);
  datagram.destination_port = big16(udp + 2);
  datagram.payload.assign(udp + kUdpHeaderBytes, udp + udp_bytes);
  return datagram;
}

}  // namespace sgraphs
