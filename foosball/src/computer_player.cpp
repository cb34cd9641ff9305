#include "foosball/computer_player.h"

#include "computer_impl.h"

namespace foosball {
namespace {

std::unique_ptr<ComputerPlayer::Impl> make(const ComputerPlayerDesc& desc) {
  const bool classic = desc.player.kind == PlayerSpec::Kind::classic;
  return classic ? make_classic_player(desc) : make_level_player(desc);
}

}  // namespace

std::uint8_t lines_of(Layout layout, int team, std::uint8_t rods) {
  const auto indices = rods_of_team(table_spec(layout), team);
  unsigned lines = 0;
  for (unsigned line = 0; line < indices.size(); ++line) {
    lines |= (rods >> indices[line] & 1U) << line;
  }
  return static_cast<std::uint8_t>(lines);
}

ComputerPlayer::ComputerPlayer(const ComputerPlayerDesc& desc) : impl_(make(desc)) {}
ComputerPlayer::~ComputerPlayer() = default;
ComputerPlayer::ComputerPlayer(ComputerPlayer&&) noexcept = default;
ComputerPlayer& ComputerPlayer::operator=(ComputerPlayer&&) noexcept = default;

void ComputerPlayer::play(const MatchView& view, RodTargets& targets, std::uint8_t rods) {
  impl_->play(view, targets, rods);
}

PlayedPass ComputerPlayer::passed() const {
  return impl_->passed();
}

}  // namespace foosball
