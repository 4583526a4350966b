#pragma once

namespace sgraphs {

// Tells the systemd that started this process as a service of Type=notify that it is ready (sd_notify(3)): a
// datagram to the socket of $NOTIFY_SOCKET. Does nothing where there is none.
void notifyReady();

}  // namespace sgraphs
