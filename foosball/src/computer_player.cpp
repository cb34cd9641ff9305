#include "foosball/computer_player.h"

#include "computer_impl.h"

namespace foosball {
namespace {

std::unique_ptr<ComputerPlayer::Impl> make(const ComputerPlayerDesc& desc) {
  const bool classic = desc.player.kind == PlayerSpec::Kind::classic;
  return classic ? make_classic_player(desc) : make_level_player(desc);
}

}  // namespace

ComputerPlayer::ComputerPlayer(const ComputerPlayerDesc& desc) : impl_(make(desc)) {}
ComputerPlayer::~ComputerPlayer() = default;
ComputerPlayer::ComputerPlayer(ComputerPlayer&&) noexcept = default;
ComputerPlayer& ComputerPlayer::operator=(ComputerPlayer&&) noexcept = default;

void ComputerPlayer::play(const MatchView& view, RodTargets& targets) {
  impl_->play(view, targets);
}

PlayedPass ComputerPlayer::passed() const {
  return impl_->passed();
}

}  // namespace foosball
