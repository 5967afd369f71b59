"""What the pages of a workbench are shown, and when."""

import asyncio
from unittest.mock import AsyncMock, Mock

from cdia_pin.app.load_step import DEMO
from cdia_pin.app.workbench import Workbench


def test_a_search_that_follows_at_once_is_not_offered_before(tmp_path):
    bench, offered = Workbench(tmp_path), []
    bench.search = AsyncMock()
    page = Mock(show=lambda *_: offered.append(bench.session is not None and not bench.searching))
    bench.pages.append(page)
    asyncio.run(bench.load(DEMO))
    assert offered
    assert not any(offered)
    bench.search.assert_awaited_once()
