"""The app in the browser: sessions without a page, and the pages that show them."""
