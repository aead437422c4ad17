"""Programs of robots' controllers: joint moves, straight lines and circular arcs with blended corners."""
