#include "drivers/recording/log_edit.h"

#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "common/bus/channels.h"
#include "common/bus/log_file.h"
#include "drivers/recording/message_header.h"

namespace sgraphs {
namespace {

class LogCopier {
 public:
  LogCopier(const LogSelection& selection, LogWriter& output) : selection_(selection), output_(output) {}

  void step(LogEvent event) {
    if (!begin_us_) begin_us_ = event.timestamp_us;
    seen_.insert(event.channel);
    const double t_s = static_cast<double>(event.timestamp_us - *begin_us_) * 1e-6;
    if (event.channel == channels::kStreamEnd.name) {
      stream_end_t message{};
      if (decode(event.bytes, message)) end_ = message;
      return;
    }
    const bool session = event.channel == channels::kSession.name;
    if (t_s < selection_.from_s) {
      if (session) session_ = std::move(event);
      return;
    }
    if (t_s > selection_.to_s || (!session && !wanted(event.channel))) return;
    if (!session) ++copied_;
    if (session) session_.reset();
    if (!session && session_) write(*std::exchange(session_, std::nullopt), event.timestamp_us);
    last_us_ = event.timestamp_us;
    write(event, event.timestamp_us);
  }

  int64_t finish(const std::string& input) {
    for (const std::string& channel : selection_.channels)
      if (!seen_.contains(channel))
        throw UsageError("channel '" + channel + "' is not in '" + input +
                         "': `sgraphs log info` lists them");
    if (copied_ == 0) throw Error("nothing of '" + input + "' lies in the part asked for");
    if (end_) writeEnd();
    return output_.events();
  }

 private:
  bool wanted(const std::string& channel) const {
    return selection_.channels.empty() || selection_.channels.contains(channel);
  }

  void write(LogEvent event, int64_t timestamp_us) {
    if (const std::optional<header_t> header = readHeader(event)) {
      const auto [base, is_new] = base_.emplace(event.channel, header->seq);
      const int64_t seq = header->seq - base->second;
      setSequence(event, seq);
      last_seq_[event.channel] = seq;
    }
    if (event.channel == channels::kSession.name) tellOdometry(event);
    output_.write(timestamp_us, event.channel, event.bytes);
  }

  // A reader waits for the odometry that SESSION promises.
  void tellOdometry(LogEvent& event) const {
    session_t message{};
    if (wanted(channels::kSpotOdometry.name) || !decode(event.bytes, message)) return;
    message.has_odometry = 0;
    event.bytes = encoded(message);
  }

  void writeEnd() {
    end_->channel.clear();
    end_->last_seq.clear();
    for (const auto& [channel, seq] : last_seq_) {
      end_->channel.push_back(channel);
      end_->last_seq.push_back(seq);
    }
    end_->num_channels = static_cast<int32_t>(end_->channel.size());
    end_->header.seq = 0;
    end_->header.utime = std::min(end_->header.utime, last_us_);
    sgraphs::write(output_, last_us_, channels::kStreamEnd, *end_);
  }

  const LogSelection& selection_;
  LogWriter& output_;
  std::optional<int64_t> begin_us_;
  std::optional<LogEvent> session_;  // newest one before the part
  std::optional<stream_end_t> end_;
  std::map<std::string, int64_t> base_, last_seq_;
  std::set<std::string> seen_;
  int64_t last_us_ = 0;
  int64_t copied_ = 0;
};

}  // namespace

int64_t copyLog(const std::string& input, const std::string& output, const LogSelection& selection) {
  if (std::filesystem::weakly_canonical(input) == std::filesystem::weakly_canonical(output))
    throw UsageError("'" + output + "' is the input itself: name another output");
  LogReader reader(input);
  LogWriter writer(output);
  try {
    LogCopier copier(selection, writer);
    while (std::optional<LogEvent> event = reader.next()) copier.step(std::move(*event));
    const int64_t events = copier.finish(input);
    writer.close();
    return events;
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(output, ignored);
    throw;
  }
}

}  // namespace sgraphs
